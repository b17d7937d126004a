#include "child_process.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"

extern char** environ;

namespace dynasurf::app {
namespace {

using Clock = std::chrono::steady_clock;

struct Running {
  std::mutex mutex;
  pid_t child = 0;  // leader of its group and not waited for yet, so that the number is nobody else's; 0: none
};

/// Never destroyed: the watcher may ask for it until the very end.
Running& running() {
  static auto* const state = new Running;
  return *state;
}

/// Between fork and exec other threads' locks may be held for ever: only calls that are safe in signal handlers.
[[noreturn]] void become(char* const* arguments, char* const* environment, pid_t parent, int report) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // it died before the line above
  const int nothing = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
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

[[noreturn]] void fail_to_start(const std::string& program, int code) {
  throw IoError("cannot start " + program + ": " + std::strerror(code));
}

std::vector<std::string> environment_with(const std::filesystem::path& temporary) {
  std::vector<std::string> variables{"TMPDIR=" + temporary.string()};
  for (char** variable = environ; variable && *variable; ++variable)
    if (std::strncmp(*variable, "TMPDIR=", 7) != 0) variables.emplace_back(*variable);
  return variables;
}

/// The words as exec wants them.
std::vector<char*> pointers_to(const std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

/// Starts the program; returns when the new process runs it, or throws when it cannot.
pid_t start(const std::vector<std::string>& words, const std::vector<std::string>& variables) {
  const std::vector<char*> arguments = pointers_to(words), environment = pointers_to(variables);
  std::array<int, 2> report{};  // tells the reason when exec fails; closed by exec when it does not
  if (::pipe2(report.data(), O_CLOEXEC) != 0) fail_to_start(words[0], errno);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) become(arguments.data(), environment.data(), parent, report[1]);
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

/// Whether the child has ended; it is waited for, and no longer killed by anyone.
bool has_ended(int& status) {
  const std::lock_guard lock(running().mutex);
  if (::waitpid(running().child, &status, WNOHANG) == 0) return false;
  running().child = 0;
  return true;
}

/// Kills all of the child's group and waits, not for long, until nobody is left who could write to a file.
void kill_group(pid_t group) {
  ::kill(-group, SIGKILL);
  const auto end = Clock::now() + std::chrono::milliseconds(300);
  for (int status = 0; !has_ended(status) && Clock::now() < end;)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  while (::kill(-group, 0) == 0 && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

}  // namespace

std::optional<int> run_quietly(const std::vector<std::string>& words, const std::filesystem::path& temporary,
                               std::chrono::seconds patience, const std::stop_token& stop) {
  pid_t child = 0;
  {
    const std::lock_guard lock(running().mutex);
    child = running().child = start(words, environment_with(temporary));
  }
  const auto end = Clock::now() + patience;
  int status = 0;
  while (!has_ended(status)) {
    const bool stopped = stop.stop_requested();
    if (stopped || Clock::now() > end) {
      kill_group(child);
      if (stopped) throw Cancelled("stopped on request");
      return std::nullopt;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return WIFEXITED(status) ? std::optional(WEXITSTATUS(status)) : std::nullopt;
}

void kill_children() noexcept {
  const std::lock_guard lock(running().mutex);
  if (running().child > 0) ::kill(-running().child, SIGKILL);
}

}  // namespace dynasurf::app
