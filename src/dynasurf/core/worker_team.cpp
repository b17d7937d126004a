#include "dynasurf/core/detail/worker_team.hpp"

#include <algorithm>
#include <utility>

namespace dynasurf::detail {

void WorkerTeam::take_pieces(Loop& loop) {
  try {
    for (std::size_t p; (p = loop.next.fetch_add(1, std::memory_order_relaxed)) < loop.pieces;) loop.piece(p);
  } catch (...) {
    loop.next = loop.pieces;
    const std::lock_guard lock(mutex_);
    if (!loop.failure) loop.failure = std::current_exception();
  }
}

void WorkerTeam::run(std::size_t pieces, const std::function<void(std::size_t)>& piece) {
  if (helpers_ == 0 || pieces <= 1) {
    for (std::size_t p = 0; p < pieces; ++p) piece(p);
    return;
  }
  Loop loop{piece, pieces};
  {
    const std::lock_guard lock(mutex_);
    open_.push_back(&loop);
  }
  opened_.notify_all();
  take_pieces(loop);
  {
    // A thread waits for pieces of its own loop alone, which wait for those within them alone: never in a circle.
    std::unique_lock lock(mutex_);
    std::erase(open_, &loop);
    left_.wait(lock, [&] { return loop.helpers == 0; });
  }
  if (loop.failure) std::rethrow_exception(loop.failure);
}

WorkerTeam::Loop* WorkerTeam::loop_for(int helper) const {
  if (limit_ > 0 && helper >= limit_) return nullptr;
  const auto found = std::ranges::find_if(open_, [](const Loop* loop) { return loop->next < loop->pieces; });
  return found == open_.end() ? nullptr : *found;
}

void WorkerTeam::help() {
  std::unique_lock lock(mutex_);
  const int number = ++helpers_;
  for (;;) {
    Loop* loop = nullptr;
    opened_.wait(lock, [&] { return is_dismissed_ || (loop = loop_for(number)); });
    if (is_dismissed_) break;
    ++loop->helpers;
    lock.unlock();
    take_pieces(*loop);
    lock.lock();
    if (--loop->helpers == 0) left_.notify_all();
  }
  --helpers_;
}

void WorkerTeam::dismiss() {
  {
    const std::lock_guard lock(mutex_);
    is_dismissed_ = true;
  }
  opened_.notify_all();
}

int WorkerTeam::limit(int threads) {
  const std::lock_guard lock(mutex_);
  return std::exchange(limit_, threads);
}

}  // namespace dynasurf::detail
