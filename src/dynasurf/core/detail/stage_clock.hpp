#pragma once
#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dynasurf/core/detail/trace.hpp"

namespace dynasurf {

/// Seconds per stage, in the order in which stages first appear: of pieces of work that several threads may do, or of
/// a walk from stage to stage. `seconds` must outlive the clock.
class StageClock {
 public:
  explicit StageClock(std::vector<std::pair<std::string, double>>& seconds) : seconds_(seconds) {}

  /// Does the work and adds its time to the stage's. May be called from any thread.
  template <class F>
  auto operator()(std::string_view stage, F&& work) {
    const TraceStage noted(stage);
    const auto start = Clock::now();
    auto result = work();
    add(stage, start);
    return result;
  }

  /// The walk goes to this stage: the one before it ends. One thread at a time.
  void enter(std::string_view stage) {
    if (stage == stage_) return;
    stop();
    stage_ = stage;
    noted_.emplace(stage);
  }
  /// The walk ends.
  void stop() {
    if (!stage_.empty()) add(stage_, entered_);
    stage_.clear();
    noted_.reset();
    entered_ = Clock::now();
  }

 private:
  using Clock = std::chrono::steady_clock;

  void add(std::string_view stage, Clock::time_point start) {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
    const std::lock_guard lock(mutex_);
    const auto entry = std::find_if(seconds_.begin(), seconds_.end(), [&](const auto& s) { return s.first == stage; });
    if (entry == seconds_.end())
      seconds_.emplace_back(stage, elapsed);
    else
      entry->second += elapsed;
  }

  std::vector<std::pair<std::string, double>>& seconds_;
  std::mutex mutex_;
  std::string stage_;
  std::optional<TraceStage> noted_;
  Clock::time_point entered_;
};

}  // namespace dynasurf
