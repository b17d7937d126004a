#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/grid.hpp"
#include "dynasurf/dynamics/detail/step_plan.hpp"

namespace dynasurf::dynamics {

/// Who is at rest (STOP-CONV, O16): who moves little in a step, and who gets nowhere for long. The second rule is ours:
/// field, smoothing and neighbours may pull a particle to and fro for ever. Who has stayed in a ball of the radius
/// `StepPlan::stray_mm` for `stray_steps`, or in one 2, 4 or 8 times as wide for as many times as long, rests.
class RestWatch {
 public:
  explicit RestWatch(std::span<const Vec3> start) {
    for (const Vec3& p : start) {
      anchors_.emplace_back();
      anchors_.back().fill({p, 0});
    }
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
  using Anchors = std::array<Anchor, 4>;  // of balls, each twice as wide as the one before
  static bool gets_nowhere(Anchors& anchors, const Vec3& position, int step, const StepPlan& plan);

  std::vector<Anchors> anchors_;  // per vertex
};

}  // namespace dynasurf::dynamics
