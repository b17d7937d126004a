#pragma once
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <vector>

namespace dynasurf::detail {

/// Threads that take pieces of loops, for a program that cannot start threads: others start them and call `help`.
class WorkerTeam {
 public:
  /// Calls `piece(p)` for each p in [0, pieces), in the calling thread and in those that help. Loops may stand within
  /// pieces. The first failure of a piece ends its loop and is thrown to the caller.
  void run(std::size_t pieces, const std::function<void(std::size_t)>& piece);

  /// Takes pieces of the loops that are there and of those that come, the outermost first, until `dismiss`.
  void help();

  /// Ends `help` in every thread that is not at a piece, and in the others after it.
  void dismiss();

  /// From now on at most `threads` work, the one that calls `run` among them (0: all). Returns what held before.
  int limit(int threads);

  /// How many threads are in `help`.
  int helpers() const { return helpers_; }

 private:
  struct Loop {
    const std::function<void(std::size_t)>& piece;
    std::size_t pieces;
    std::atomic<std::size_t> next = 0;
    int helpers = 0;               // under mutex_
    std::exception_ptr failure{};  // under mutex_
  };
  void take_pieces(Loop& loop);
  Loop* loop_for(int helper) const;

  std::mutex mutex_;
  std::condition_variable opened_, left_;
  std::vector<Loop*> open_;  // from the outermost inwards
  std::atomic<int> helpers_ = 0;
  int limit_ = 0;
  bool is_dismissed_ = false;
};

}  // namespace dynasurf::detail
