#pragma once
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "dynasurf/dynamics/evolve.hpp"

namespace dynasurf::python {

/// What a motion needs, kept for as long as it runs.
struct Motion {
  std::shared_ptr<TriMesh> start;
  std::shared_ptr<field::VectorField> field;
  std::shared_ptr<Image> border;
  dynamics::Evolution options;
  std::shared_ptr<dynamics::BorderPlanes> planes;
  dynamics::Additions own;
};

/// A motion on a thread of its own that waits after every so many steps until it is asked for the next ones.
class Stepper {
 public:
  struct State {
    int steps = 0;
    std::shared_ptr<TriMesh> mesh;
  };

  Stepper(Motion motion, int every);
  ~Stepper();
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// The next state; absent at the end. Holds the interpreter's lock when called, not while it waits. Throws what the
  /// motion or a signal handler throws.
  std::optional<State> next();
  /// Ends the motion where it stands.
  void close();
  /// Null before the end.
  std::shared_ptr<dynamics::EvolutionResult> result();

 private:
  void run();
  void hand_over(int steps, const TriMesh& mesh);

  Motion motion_;
  const int every_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool asked_ = false, is_done_ = false;
  std::optional<State> ready_;
  std::shared_ptr<dynamics::EvolutionResult> result_;
  std::exception_ptr failure_;
  std::stop_source stop_;
  std::thread thread_;
};

}  // namespace dynasurf::python
