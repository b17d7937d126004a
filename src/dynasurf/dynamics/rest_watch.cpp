#include "dynasurf/dynamics/rest_watch.hpp"

namespace dynasurf {

std::size_t RestWatch::count(std::span<const std::uint32_t> moving, std::span<const Vec3> vertices,
                             std::span<const Vec3> before, int step, const StepPlan& plan) {
  std::size_t count = 0;
  for (std::size_t s = 0; s < moving.size(); ++s) {
    const Vec3& position = vertices[moving[s]];
    Anchor& anchor = anchors_[moving[s]];
    if ((position - anchor.place).squaredNorm() > plan.stray_mm * plan.stray_mm) anchor = {position, step};
    const bool is_slow = (position - before[s]).squaredNorm() < plan.rest_mm * plan.rest_mm;
    if (is_slow || (plan.stray_steps > 0 && step - anchor.step >= plan.stray_steps)) ++count;
  }
  return count;
}

}  // namespace dynasurf
