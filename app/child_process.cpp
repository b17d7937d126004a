#include "child_process.hpp"

#include <array>
#include <cerrno>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"

#include "child_start.hpp"

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

double seconds_of(const timeval& time) { return time.tv_sec + 1e-6 * time.tv_usec; }

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
    // Memory first: a child that was started and not noted could not be killed.
    running().children.reserve(running().children.size() + 1);
    child_ = start_child(words, environment, pipe[1], memory_bytes);
    running().children.push_back(child_);
  } catch (...) {
    ::close(pipe[0]);
    ::close(pipe[1]);
    throw;
  }
  ::close(pipe[1]);  // the child has its own; with this one open, its words would never end
}

ChildProgram::~ChildProgram() {
  kill();
  ::close(errors_);
}

void ChildProgram::listen() {
  constexpr std::size_t most_kept = 4096;
  std::array<char, 4096> buffer;
  for (ssize_t got = 0; (got = ::read(errors_, buffer.data(), buffer.size())) > 0;) {
    words_.append(buffer.data(), got);
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
    // Under the lock: once it is waited for, the number may be another process's.
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
  // Its own children are not ours to wait for: the group is gone when no signal finds it.
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
