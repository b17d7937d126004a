#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/grid.hpp"
#include "dynasurf/dynamics/step_plan.hpp"

namespace dynasurf {

/// Who is at rest (STOP-CONV, O16): who moves little in a step, and who has not left the neighbourhood of a place for
/// long. The second rule is ours: field and smoothing may pull a particle to and fro for ever.
class RestWatch {
 public:
  explicit RestWatch(std::span<const Vec3> start) {
    for (const Vec3& p : start) anchors_.push_back({p, 0});
  }

  /// How many of the `moving` particles are at rest after `step`; `before` holds their places before it, in the order
  /// of `moving`.
  std::size_t count(std::span<const std::uint32_t> moving, std::span<const Vec3> vertices, std::span<const Vec3> before,
                    int step, const StepPlan& plan);

 private:
  /// Where a particle was when it last left the neighbourhood of such a place.
  struct Anchor {
    Vec3 place;
    int step = 0;
  };
  std::vector<Anchor> anchors_;  // per vertex
};

}  // namespace dynasurf
