#include "stepper.hpp"

#include <chrono>
#include <utility>

#include <pybind11/pybind11.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf::python {

namespace py = pybind11;
using namespace std::chrono_literals;

Stepper::Stepper(Motion motion, int every) : motion_(std::move(motion)), every_(every) {
  motion_.own.planes = motion_.planes.get();
  motion_.own.watch = [this](int steps, const TriMesh& mesh) {
    if (steps % every_ == 0) hand_over(steps, mesh);
  };
}

Stepper::~Stepper() { close(); }

void Stepper::run() {
  std::exception_ptr failure;
  std::shared_ptr<dynamics::EvolutionResult> result;
  try {
    result = std::make_shared<dynamics::EvolutionResult>(dynamics::evolve(
        *motion_.start, *motion_.field, *motion_.border, motion_.options, {{}, stop_.get_token()}, motion_.own));
  } catch (const Cancelled&) {  // by close()
  } catch (...) {
    failure = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  result_ = std::move(result);
  failure_ = std::move(failure);
  is_done_ = true;
  changed_.notify_all();
}

void Stepper::hand_over(int steps, const TriMesh& mesh) {
  std::unique_lock lock(mutex_);
  ready_ = State{steps, std::make_shared<TriMesh>(mesh)};
  asked_ = false;
  changed_.notify_all();
  changed_.wait(lock, [this] { return asked_ || stop_.stop_requested(); });
  if (stop_.stop_requested()) throw Cancelled("stopped on request");
}

std::optional<Stepper::State> Stepper::next() {
  if (!thread_.joinable() && !is_done_) thread_ = std::thread([this] { run(); });
  {
    const std::lock_guard lock(mutex_);
    asked_ = true;
    changed_.notify_all();
  }
  for (bool is_ready = false; !is_ready;) {
    {
      const py::gil_scoped_release release;
      std::unique_lock lock(mutex_);
      is_ready = changed_.wait_for(lock, 50ms, [this] { return ready_ || is_done_; });
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  const std::lock_guard lock(mutex_);
  if (ready_) return std::exchange(ready_, std::nullopt);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::nullopt;
}

void Stepper::close() {
  stop_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    changed_.notify_all();
  }
  const py::gil_scoped_release release;
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(mutex_);
  is_done_ = true;
  ready_.reset();
}

std::shared_ptr<dynamics::EvolutionResult> Stepper::result() {
  const std::lock_guard lock(mutex_);
  return result_;
}

}  // namespace dynasurf::python
