#include <algorithm>
#include <chrono>
#include <filesystem>
#include <latch>
#include <system_error>
#include <thread>
#include <vector>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#if defined(__SANITIZE_THREAD__)
#include <atomic>
#include <exception>
#include <mutex>
#endif

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/detail/run_pieces.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf {

#if defined(__SANITIZE_THREAD__)
/// The thread sanitizer does not see how oneTBB, which is not compiled with it, hands work from thread to thread, and
/// would call every piece a race. Here the pieces run on threads of their own, and what it then sees is the pieces.
/// More threads than processors show more races; only a limit of one thread holds.
void detail::run_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece) {
  using oneapi::tbb::global_control;
  const bool is_alone = global_control::active_value(global_control::max_allowed_parallelism) == 1;
  const std::size_t most_threads = is_alone ? 1 : 4;
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex guard;
  const auto work = [&] {
    try {
      for (std::size_t p; (p = next.fetch_add(1, std::memory_order_relaxed)) < pieces;) piece(p);
    } catch (...) {
      next = pieces;
      const std::lock_guard lock(guard);
      failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t t = 1; t < std::min(pieces, most_threads); ++t) try {
        others.emplace_back(work);
      } catch (const std::system_error&) {  // those that started do it
        break;
      }
    work();
  }
  if (failure) std::rethrow_exception(failure);
}
#else
void detail::run_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece) {
  oneapi::tbb::parallel_for(std::size_t{0}, pieces, piece);
}
#endif

void parallel_for_files(std::size_t count, const std::function<void(std::size_t)>& body) {
  detail::run_noted_pieces(count, body);
}

namespace {

std::ptrdiff_t threads_of_process() {
  std::error_code error;
  const std::filesystem::directory_iterator tasks("/proc/self/task", error);
  return error ? 0 : std::distance(begin(tasks), end(tasks));
}

/// How many of `wanted` more threads the system lets this process start.
int startable(int wanted) {
  using namespace std::chrono_literals;
  const std::ptrdiff_t before = threads_of_process();
  std::size_t count = 0;
  {
    std::latch counted(1);
    std::vector<std::jthread> started;
    try {
      while (std::ssize(started) < wanted) started.emplace_back([&] { counted.wait(); });
    } catch (const std::system_error&) {
    } catch (...) {
      counted.count_down();
      throw;
    }
    count = started.size();
    counted.count_down();
  }
  // The system counts a thread that was joined a moment longer, and would refuse the next one in its place.
  for (int n = 0; std::cmp_less(count, wanted) && threads_of_process() > before && n < 1000; ++n)
    std::this_thread::sleep_for(1ms);
  return count;
}

/// Where the system refuses some of the threads, oneTBB shall not ask for them: neither now nor when a limit ends, so
/// this one never does.
void keep_to_threads_to_be_had(int asked) {
  constexpr int most = 256;
  const int wanted = std::clamp(std::max<int>(asked, std::thread::hardware_concurrency()), 1, most);
  const int have = 1 + startable(wanted - 1);
  if (have >= wanted) return;
  using oneapi::tbb::global_control;
  static const global_control* kept = nullptr;  // the first is the strictest that is needed
  if (!kept) kept = new global_control(global_control::max_allowed_parallelism, have);
}

}  // namespace

struct ThreadLimit::State {
  oneapi::tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : state_(threads > 0
                 ? new State{oneapi::tbb::global_control(oneapi::tbb::global_control::max_allowed_parallelism, threads)}
                 : nullptr) {
  try {
    keep_to_threads_to_be_had(threads);
    // oneTBB loads a library first, and the loader of the system does not survive the want of memory everywhere.
    require_room(std::size_t{8} << 20);
    parallel_for(2, 1, [](std::size_t, std::size_t) {});
  } catch (...) {
    // The end of a control waits for ever for a scheduler that could not be started: it is given up.
    (void)state_.release();
    throw;
  }
}
ThreadLimit::~ThreadLimit() = default;

}  // namespace dynasurf
