#include "dynasurf/core/parallel.hpp"

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

#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

#if defined(__SANITIZE_THREAD__)
/// The thread sanitizer does not see how oneTBB, which is not compiled with it, hands work from thread to thread, and
/// would call every piece a race. Here the pieces run on threads of their own, and what it then sees is the pieces.
void run_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece) {
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
void run_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece) {
  oneapi::tbb::parallel_for(std::size_t{0}, pieces, piece);
}
#endif

}  // namespace

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  DYNASURF_ASSERT(grain > 0);
  const std::size_t pieces = (count + grain - 1) / grain;
  if (pieces <= 1) {
    if (count > 0) body(0, count);
    return;
  }
  run_pieces(pieces, [&](std::size_t p) { body(p * grain, std::min(count, (p + 1) * grain)); });
}

namespace {

std::vector<double> per_piece(std::size_t count, std::size_t grain,
                              const std::function<double(std::size_t, std::size_t)>& body) {
  std::vector<double> results((count + grain - 1) / grain, 0.0);
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) { results[begin / grain] = body(begin, end); });
  return results;
}

}  // namespace

double parallel_sum(std::size_t count, std::size_t grain, const std::function<double(std::size_t, std::size_t)>& body) {
  double sum = 0;
  for (double s : per_piece(count, grain, body)) sum += s;
  return sum;
}

double parallel_max(std::size_t count, std::size_t grain, const std::function<double(std::size_t, std::size_t)>& body) {
  double largest = 0;
  for (double m : per_piece(count, grain, body)) largest = std::max(largest, m);
  return largest;
}

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
