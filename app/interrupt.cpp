#include "interrupt.hpp"

#include <csignal>

#include <pthread.h>
#include <unistd.h>

namespace dynasurf::app {
namespace {

constexpr int end_of_watch = SIGUSR1;

sigset_t watched() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, end_of_watch}) sigaddset(&set, signal);
  return set;
}

}  // namespace

Interrupt::Interrupt() {
  const sigset_t set = watched();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  watcher_ = std::thread([this, set] {
    for (int signal = 0; sigwait(&set, &signal) == 0 && signal != end_of_watch;) {
      if (source_.stop_requested()) ::_exit(3);
      source_.request_stop();
    }
  });
}

Interrupt::~Interrupt() {
  pthread_kill(watcher_.native_handle(), end_of_watch);
  watcher_.join();
}

}  // namespace dynasurf::app
