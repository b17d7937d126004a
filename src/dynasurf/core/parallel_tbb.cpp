#include <algorithm>
#include <vector>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#if defined(__SANITIZE_THREAD__)
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#endif

#include "dynasurf/core/detail/run_pieces.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf {

#if defined(__SANITIZE_THREAD__)
/// The thread sanitizer does not see how oneTBB, which is not compiled with it, hands work from thread to thread, and
/// would call every piece a race. Here the pieces run on threads of their own, and what it then sees is the pieces.
void detail::run_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece) {
  constexpr std::size_t most_threads = 4;
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
    for (std::size_t t = 1; t < std::min(pieces, most_threads); ++t) others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}
#else
void detail::run_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece) {
  oneapi::tbb::parallel_for(std::size_t{0}, pieces, piece);
}
#endif

struct ThreadLimit::State {
  oneapi::tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : state_(threads > 0 ? new State{oneapi::tbb::global_control(oneapi::tbb::global_control::max_allowed_parallelism,
                                                                 static_cast<std::size_t>(threads))}
                         : nullptr) {
  try {
    // oneTBB loads a library first, and the loader of the system does not survive the want of memory everywhere.
    { const std::vector<char> library(std::size_t{8} << 20); }
    parallel_for(2, 1, [](std::size_t, std::size_t) {});
  } catch (...) {
    // The end of a control waits for ever for a scheduler that could not be started: it is given up.
    (void)state_.release();
    throw;
  }
}
ThreadLimit::~ThreadLimit() = default;

}  // namespace dynasurf
