#pragma once
#include <algorithm>
#include <chrono>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dynasurf {

/// Seconds per stage, added up from several threads, in the order in which stages first appear.
class StageClock {
 public:
  explicit StageClock(std::vector<std::pair<std::string, double>>& seconds) : seconds_(seconds) {}

  template <class F>
  auto operator()(std::string_view stage, F&& work) {
    const auto start = std::chrono::steady_clock::now();
    auto result = work();
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::lock_guard lock(mutex_);
    const auto entry = std::find_if(seconds_.begin(), seconds_.end(), [&](const auto& s) { return s.first == stage; });
    if (entry == seconds_.end())
      seconds_.emplace_back(stage, elapsed);
    else
      entry->second += elapsed;
    return result;
  }

 private:
  std::vector<std::pair<std::string, double>>& seconds_;
  std::mutex mutex_;
};

}  // namespace dynasurf
