#pragma once
#include <stop_token>
#include <thread>

namespace dynasurf::app {

/// Turns Ctrl-C (SIGINT), SIGTERM and SIGHUP into a stop request; the second one ends the program at once. Make it
/// before any other thread starts, because threads inherit which signals they leave alone.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::thread watcher_;
};

}  // namespace dynasurf::app
