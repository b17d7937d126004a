#pragma once
#include <memory>

namespace dynasurf::cloud {

/// What the stages of the last call of `reconstruct` found, kept by the caller for the next one: the points and the
/// body. A stage is done again only where the cloud or one of the options that it or a stage before it depends on has
/// changed. The result is the same, byte for byte. Holds the cloud three times, and the fields of the body. Of one call
/// at a time.
class StageCache {
 public:
  StageCache();
  ~StageCache();
  StageCache(StageCache&&) noexcept;
  StageCache& operator=(StageCache&&) noexcept;

  /// Defined where stages are done.
  struct Kept;
  /// What is kept; never null.
  Kept& kept() { return *kept_; }

 private:
  std::unique_ptr<Kept> kept_;
};

}  // namespace dynasurf::cloud
