#include "running.hpp"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "dynasurf/core/parallel.hpp"

namespace dynasurf::python {
namespace {

using namespace std::chrono_literals;

struct Event {
  std::string stage;
  int done = 0, total = 0;
};

/// What the working and the waiting thread share.
struct Run {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Event> events;
  bool is_done = false;
  std::exception_ptr failure;
  std::stop_source stop;

  void tell(std::string_view stage, int done, int total) {
    const std::lock_guard lock(mutex);
    events.push_back({std::string(stage), done, total});
  }
  void end(std::exception_ptr why) {
    const std::lock_guard lock(mutex);
    failure = std::move(why);
    is_done = true;
    changed.notify_all();
  }
  /// Whether the work ends within this time.
  bool wait(std::chrono::milliseconds most) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, most, [this] { return is_done; });
  }
  std::deque<Event> take_events() {
    const std::lock_guard lock(mutex);
    return std::exchange(events, {});
  }
};

std::mutex abandoned_mutex;
std::vector<std::thread>& abandoned() {
  static auto* threads = new std::vector<std::thread>;  // outlives every static object: its threads may, too
  return *threads;
}

void work_on(const std::shared_ptr<Run>& run, int threads, std::function<void(const Progress&)> work) {
  std::exception_ptr failure;
  try {
    const ThreadLimit limit(threads);
    work(
        {[run](std::string_view stage, int done, int total) { run->tell(stage, done, total); }, run->stop.get_token()});
  } catch (...) {
    failure = std::current_exception();
  }
  work = {};  // what it holds goes before the result is taken
  run->end(std::move(failure));
}

/// Calls the progress function, and raises what it or a signal handler raised.
void tell_python(Run& run, const py::object& progress) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  const auto events = run.take_events();
  if (progress.is_none()) return;
  for (const Event& event : events) progress(event.stage, event.done, event.total);
}

}  // namespace

void run_long(const RunArguments& arguments, std::function<void(const Progress&)> work) {
  const auto run = std::make_shared<Run>();
  std::thread worker(work_on, run, arguments.threads, std::move(work));
  constexpr auto patience = 100ms;
  try {
    for (auto pause = 2ms; true; pause = std::min<std::chrono::milliseconds>(2 * pause, 30ms)) {
      bool is_done = false;
      {
        const py::gil_scoped_release release;
        is_done = run->wait(pause);
      }
      tell_python(*run, arguments.progress);
      if (is_done) break;
    }
  } catch (...) {
    run->stop.request_stop();
    bool is_done = false;
    {
      const py::gil_scoped_release release;
      is_done = run->wait(patience);
      if (is_done) worker.join();
    }
    if (!is_done) {
      const std::lock_guard lock(abandoned_mutex);
      abandoned().push_back(std::move(worker));
    }
    throw;
  }
  {
    const py::gil_scoped_release release;
    worker.join();
  }
  if (run->failure) std::rethrow_exception(run->failure);
}

SharedFunction shared_function(py::object function) {
  return {new py::object(std::move(function)), [](py::object* held) {
            const py::gil_scoped_acquire acquire;
            delete held;
          }};
}

void wait_for_abandoned() {
  std::vector<std::thread> threads;
  {
    const std::lock_guard lock(abandoned_mutex);
    threads = std::exchange(abandoned(), {});
  }
  const py::gil_scoped_release release;
  for (std::thread& thread : threads) thread.join();
}

}  // namespace dynasurf::python
