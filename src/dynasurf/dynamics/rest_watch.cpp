#include "dynasurf/dynamics/detail/rest_watch.hpp"

namespace dynasurf::dynamics {

bool RestWatch::gets_nowhere(Anchors& anchors, const Vec3& position, int step, const StepPlan& plan) {
  bool is_held = false;
  double wider = 1;
  for (Anchor& anchor : anchors) {
    const double radius = wider * plan.stray_mm;
    if ((position - anchor.place).squaredNorm() > radius * radius)
      anchor = {position, step};
    else if (plan.stray_steps > 0 && step - anchor.step >= wider * plan.stray_steps)
      is_held = true;
    wider *= 2;
  }
  return is_held;
}

std::size_t RestWatch::count(std::span<const std::uint32_t> moving, std::span<const Vec3> vertices,
                             std::span<const Vec3> before, int step, const StepPlan& plan) {
  std::size_t count = 0;
  for (std::size_t s = 0; s < moving.size(); ++s) {
    const Vec3& position = vertices[moving[s]];
    const bool is_held = gets_nowhere(anchors_[moving[s]], position, step, plan);
    if (is_held || (position - before[s]).squaredNorm() < plan.rest_mm * plan.rest_mm) ++count;
  }
  return count;
}

}  // namespace dynasurf::dynamics
