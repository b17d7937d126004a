#include "dynasurf/dynamics/detail/border_stop.hpp"

namespace dynasurf::dynamics {

std::optional<Vec3> BorderStop::on_path(const Vec3& step_begin, const Vec3& from, const Vec3& to) const {
  std::optional<Vec3> stop;
  if (own_) stop = own_(from, to);
  if (!options_.enabled) return stop;
  const Vec3 end = stop.value_or(to);
  if (const std::optional<BorderHit> hit = path_.first_hit(from, end)) stop = point_in(*hit, step_begin, end - from);
  return stop;
}

Vec3 BorderStop::point_in(const BorderHit& hit, const Vec3& step_begin, const Vec3& way) const {
  switch (options_.point) {
    case StopPoint::entry:
      return hit.entry;
    case StopPoint::centre:
      return centre_of(grid_, hit.voxel);
    case StopPoint::backtrack:
      return step_begin;
    case StopPoint::subvoxel:
      return meeting_point(grid_, planes_, hit, way);
  }
  return hit.entry;
}

}  // namespace dynasurf::dynamics
