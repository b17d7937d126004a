#include "child_start.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"

extern char** environ;

namespace dynasurf::app {
namespace {

/// Between fork and exec other threads' locks may be held for ever: only calls that are safe in signal handlers.
[[noreturn]] void become(char* const* arguments, char* const* environment, pid_t parent, int report, int errors,
                         std::uint64_t memory_bytes) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // it died before the line above
  const int nothing = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO}) ::dup2(nothing, stream);
  ::dup2(errors >= 0 ? errors : nothing, STDERR_FILENO);
  if (memory_bytes > 0) {
    const rlimit limit{memory_bytes, memory_bytes};
    ::setrlimit(RLIMIT_DATA, &limit);
  }
  if (nothing > STDERR_FILENO) ::close(nothing);
  ::signal(SIGPIPE, SIG_DFL);
  ::signal(SIGXFSZ, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execve(arguments[0], arguments, environment);
  const int code = errno;
  [[maybe_unused]] const ssize_t told = ::write(report, &code, sizeof code);
  ::_exit(127);
}

/// The words as exec wants them.
std::vector<char*> pointers_to(const std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

[[noreturn]] void fail_to_start(const std::string& program, int code) {
  throw IoError("cannot start " + program + ": " + std::strerror(code));
}

std::vector<std::string> environment_with(std::vector<std::string> variables) {
  const std::size_t own = variables.size();
  const auto name_of = [](std::string_view variable) { return variable.substr(0, variable.find('=')); };
  for (char** variable = environ; variable && *variable; ++variable)
    if (std::none_of(variables.begin(), variables.begin() + own,
                     [&](const std::string& given) { return name_of(given) == name_of(*variable); }))
      variables.emplace_back(*variable);
  return variables;
}

pid_t start_child(const std::vector<std::string>& words, const std::vector<std::string>& variables, int errors,
                  std::uint64_t memory_bytes) {
  const std::vector<char*> arguments = pointers_to(words), environment = pointers_to(variables);
  std::array<int, 2> report{};  // tells the reason when exec fails; closed by exec when it does not
  if (::pipe2(report.data(), O_CLOEXEC) != 0) fail_to_start(words[0], errno);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) become(arguments.data(), environment.data(), parent, report[1], errors, memory_bytes);
  const int fork_error = errno;
  ::close(report[1]);
  int code = 0;
  const bool failed = child > 0 && ::read(report[0], &code, sizeof code) == static_cast<ssize_t>(sizeof code);
  ::close(report[0]);
  if (child < 0) fail_to_start(words[0], fork_error);
  if (failed) {
    ::waitpid(child, nullptr, 0);
    fail_to_start(words[0], code);
  }
  return child;
}

}  // namespace dynasurf::app
