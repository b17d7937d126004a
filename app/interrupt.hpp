#pragma once
#include <atomic>
#include <stop_token>
#include <string>
#include <thread>

#include <signal.h>

namespace dynasurf::app {

/// Turns the first Ctrl-C (SIGINT), SIGTERM or SIGHUP into a stop request. A command that has not come back soon after
/// it is ended from here: nothing more can be published, what was begun is removed, child programs are killed, one line
/// says so, and the exit code is 3. The second signal ends the program at once. Make it before any other thread starts,
/// because threads inherit which signals they leave alone. Throws IoError when its thread cannot be started.
class Interrupt {
 public:
  Interrupt();
  /// From here on the program ends by itself. Never returns where the watcher has begun to end it.
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  void watch(const sigset_t& set);
  bool comes_back(const sigset_t& set, int patience_ms) const;
  void end_process(const sigset_t& set);

  std::stop_source source_;
  std::atomic_flag ends_;  // set by who ends the program: the command that came back, or the watcher
  std::thread watcher_;
};

/// Whether the watcher has taken back what was begun: whatever fails from then on fails because of it.
bool is_taken_back();

/// What a run that was stopped says, and what is true: whether a result stands.
std::string words_of_stop();

}  // namespace dynasurf::app
