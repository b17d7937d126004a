#include "interrupt.hpp"

#include <ctime>
#include <system_error>

#include <pthread.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"

#include "child_process.hpp"
#include "command.hpp"
#include "console.hpp"
#include "removed_at_end.hpp"

namespace dynasurf::app {
namespace {

constexpr int end_of_watch = SIGUSR1;

// How long a command may take to come back after the first signal. One that has begun to write has its own to clean up;
// the others lose nothing. Together with cleaning up from here it stays below one second.
constexpr int patience_with_readers_ms = 50;
constexpr int patience_with_writers_ms = 600;
constexpr int patience_with_finished_ms = 250;

std::atomic<bool> taken_back{false};

sigset_t watched() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, end_of_watch}) sigaddset(&set, signal);
  return set;
}

/// The next of the signals, or 0 when the time is over.
int next_signal(const sigset_t& set, int wait_ms) {
  const timespec time{wait_ms / 1000, (wait_ms % 1000) * 1000000L};
  const int signal = sigtimedwait(&set, nullptr, &time);
  return signal > 0 ? signal : 0;
}

}  // namespace

bool is_taken_back() { return taken_back; }

std::string words_of_stop() {
  return io::state_of_outputs() == io::OutputState::published ? "stopped on request; the result had been written before"
                                                              : "stopped on request; nothing was written";
}

Interrupt::Interrupt() {
  const sigset_t set = watched();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  try {
    watcher_ = std::thread([this, set] { watch(set); });
  } catch (const std::system_error&) {  // no thread to be had: the signals end the program, and the next run tidies up
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  }
}

Interrupt::~Interrupt() {
  if (!watcher_.joinable()) return;
  while (ends_.test_and_set()) pause();  // the watcher is about to end the process
  pthread_kill(watcher_.native_handle(), end_of_watch);
  watcher_.join();
}

void Interrupt::watch(const sigset_t& set) {
  int signal = 0;
  while (sigwait(&set, &signal) != 0) {
  }
  if (signal == end_of_watch) return;
  source_.request_stop();
  const bool writes = io::state_of_outputs() != io::OutputState::none;
  if (!comes_back(set, writes ? patience_with_writers_ms : patience_with_readers_ms)) end_process(set);
}

/// Whether the command came back by itself. A second signal does not wait for it.
bool Interrupt::comes_back(const sigset_t& set, int patience_ms) const {
  const int signal = next_signal(set, patience_ms);
  if (signal == end_of_watch) return true;
  if (signal != 0) {
    kill_children();
    ::_exit(not_trustworthy);
  }
  return false;
}

void Interrupt::end_process(const sigset_t& set) {
  taken_back = true;
  kill_children();
  io::discard_unpublished();
  // Now it is settled whether there is a result. Where there is one, only the last words are missing: let it tell them.
  if (io::state_of_outputs() == io::OutputState::published && comes_back(set, patience_with_finished_ms)) return;
  if (ends_.test_and_set()) return;  // it came back after all
  remove_what_goes_at_end();
  print_error(words_of_stop());
  ::_exit(not_trustworthy);
}

}  // namespace dynasurf::app
