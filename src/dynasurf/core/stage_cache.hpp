#pragma once
#include <memory>

namespace dynasurf {

/// Holds what a run kept for the next one. `Kept` needs to be complete only where `kept` is called.
template <class Kept>
class StageCache {
 public:
  StageCache() = default;
  StageCache(StageCache&&) noexcept = default;
  StageCache& operator=(StageCache&&) noexcept = default;

  /// Empty at first.
  Kept& kept() {
    if (!kept_) kept_ = std::make_shared<Kept>();
    return *kept_;
  }

 private:
  std::shared_ptr<Kept> kept_;  // never shared: it remembers how an incomplete type is destroyed
};

}  // namespace dynasurf
