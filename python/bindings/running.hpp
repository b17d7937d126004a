#pragma once
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

#include "dynasurf/core/progress.hpp"

#include "bindings.hpp"

namespace dynasurf::python {

/// What every long call takes beside its own arguments.
struct RunArguments {
  py::object progress;  // called with (stage, done, total) in the calling thread; or None
  int threads = 0;      // at most; 0: all
};

/// Does `work` on a thread of its own, without the interpreter's lock, while the calling thread tells progress and
/// looks for Ctrl-C. Whatever the calling thread meets (KeyboardInterrupt, an exception of the progress function) asks
/// the work to stop and is raised within 0.2 s. Work that has not come to a place where it can stop by then ends by
/// itself later, so it must own all that it uses. Throws what the work throws.
void run_long(const RunArguments& arguments, std::function<void(const Progress&)> work);

/// The same for work that returns something.
template <class Work>
auto run_long_for(const RunArguments& arguments, Work work) {
  using Result = std::invoke_result_t<Work&, const Progress&>;
  auto result = std::make_shared<std::optional<Result>>();
  run_long(arguments, [result, work = std::move(work)](const Progress& progress) { *result = work(progress); });
  return std::move(**result);
}

/// A Python function that C++ threads call and give up: its reference is dropped with the interpreter's lock held.
using SharedFunction = std::shared_ptr<py::object>;
SharedFunction shared_function(py::object function);

/// Waits, without the interpreter's lock, for work that was asked to stop and has not ended. Called when Python ends.
void wait_for_abandoned();

}  // namespace dynasurf::python
