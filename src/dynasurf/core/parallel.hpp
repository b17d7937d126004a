#pragma once
#include <cstddef>
#include <functional>
#include <memory>

namespace dynasurf {

/// Calls `body(begin, end)` on disjoint pieces that cover [0, count), from several threads. Pieces are cut at
/// multiples of `grain` (the last one may be shorter), whatever the number of threads, so a body that treats each
/// piece by itself gives the same bytes on one thread or many.
void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Sum of `body(begin, end)` over the pieces, added in the order of the pieces: the same bytes for any thread count.
double parallel_sum(std::size_t count, std::size_t grain, const std::function<double(std::size_t, std::size_t)>& body);

/// Largest of `body(begin, end)` over the pieces; 0 when there are none.
double parallel_max(std::size_t count, std::size_t grain, const std::function<double(std::size_t, std::size_t)>& body);

/// Calls `body(n)` for each n in [0, count) from as many threads as there are that may read and write files.
void parallel_for_files(std::size_t count, const std::function<void(std::size_t)>& body);

/// While it lives, at most `threads` threads work in parallel loops (0: as many as the machine has). Starts the
/// scheduler of oneTBB, so that what it needs is missed here and not within a loop.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dynasurf
