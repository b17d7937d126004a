#include "child_process.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <thread>

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

using Clock = std::chrono::steady_clock;

struct Running {
  std::mutex mutex;
  std::vector<pid_t> children;  // leaders of their groups and not waited for yet: the numbers are nobody else's
};

/// Never destroyed: the watcher may ask for it until the very end.
Running& running() {
  static auto* const state = new Running;
  return *state;
}

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

[[noreturn]] void fail_to_start(const std::string& program, int code) {
  throw IoError("cannot start " + program + ": " + std::strerror(code));
}

/// `variables`, and those of this process that are not named among them.
std::vector<std::string> environment_with(std::vector<std::string> variables) {
  const std::size_t own = variables.size();
  const auto name_of = [](std::string_view variable) { return variable.substr(0, variable.find('=')); };
  for (char** variable = environ; variable && *variable; ++variable)
    if (std::none_of(variables.begin(), variables.begin() + static_cast<std::ptrdiff_t>(own),
                     [&](const std::string& given) { return name_of(given) == name_of(*variable); }))
      variables.emplace_back(*variable);
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
pid_t start(const std::vector<std::string>& words, const std::vector<std::string>& variables, int errors,
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

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

ChildProgram::ChildProgram(const std::vector<std::string>& words, const std::vector<std::string>& variables,
                           std::uint64_t memory_bytes) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) fail_to_start(words[0], errno);
  ::fcntl(pipe[0], F_SETFL, O_NONBLOCK);
  errors_ = pipe[0];
  try {
    const std::vector<std::string> environment = environment_with(variables);
    const std::lock_guard lock(running().mutex);
    running().children.reserve(running().children.size() + 1);
    child_ = start(words, environment, pipe[1], memory_bytes);
    running().children.push_back(child_);
  } catch (...) {
    ::close(pipe[0]);
    ::close(pipe[1]);
    throw;
  }
  ::close(pipe[1]);
}

ChildProgram::~ChildProgram() {
  kill();
  ::close(errors_);
}

void ChildProgram::listen() {
  constexpr std::size_t most_kept = 4096;
  std::array<char, 4096> buffer;
  for (ssize_t got = 0; (got = ::read(errors_, buffer.data(), buffer.size())) > 0;) {
    words_.append(buffer.data(), static_cast<std::size_t>(got));
    if (words_.size() > most_kept) words_.erase(0, words_.size() - most_kept);
  }
}

std::optional<ChildEnd> ChildProgram::end() {
  listen();
  if (ended_) return ended_;
  int status = 0;
  rusage used{};
  {
    const std::lock_guard lock(running().mutex);
    if (::wait4(child_, &status, WNOHANG, &used) == 0) return std::nullopt;
    std::erase(running().children, child_);
  }
  child_ = 0;
  listen();
  ChildEnd ended;
  if (WIFEXITED(status)) ended.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ended.signal = WTERMSIG(status);
  ended.cpu_s = seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
  ended.peak_mb = static_cast<double>(used.ru_maxrss) / 1024;  // the system tells kB
  return ended_ = ended;
}

void ChildProgram::ask_to_stop() const {
  if (child_ > 0) ::kill(-child_, SIGTERM);
}

void ChildProgram::kill() {
  if (child_ == 0) return;
  const pid_t group = child_;
  ::kill(-group, SIGKILL);
  const auto limit = Clock::now() + std::chrono::milliseconds(300);
  while (!end() && child_ != 0 && Clock::now() < limit) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  while (::kill(-group, 0) == 0 && Clock::now() < limit) std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

std::optional<int> run_quietly(const std::vector<std::string>& words, const std::filesystem::path& temporary,
                               std::chrono::seconds patience, const std::stop_token& stop) {
  ChildProgram child(words, {"TMPDIR=" + temporary.string()}, 0);
  const auto limit = Clock::now() + patience;
  while (true) {
    if (const auto ended = child.end()) return ended->code;
    if (stop.stop_requested()) {
      child.kill();
      throw Cancelled("stopped on request");
    }
    if (Clock::now() > limit) {
      child.kill();
      return std::nullopt;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

void kill_children() noexcept {
  const std::lock_guard lock(running().mutex);
  for (const pid_t child : running().children) ::kill(-child, SIGKILL);
}

}  // namespace dynasurf::app
