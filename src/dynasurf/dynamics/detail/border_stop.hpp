#pragma once
#include "dynasurf/dynamics/detail/border_path.hpp"
#include "dynasurf/dynamics/detail/border_planes.hpp"
#include "dynasurf/dynamics/options.hpp"

namespace dynasurf::dynamics {

/// Where particles stop for good: in border voxels (STOP-VOXEL, FUT-STOPCONTOUR) and where the caller says. `planes`
/// and the caller's stop must outlive it.
class BorderStop {
 public:
  BorderStop(const Image& border, const StopVoxel& options, const BorderPlanes* planes, const OwnStop& own)
      : grid_(border.grid), options_(options), path_(border), planes_(planes), own_(own) {}

  /// The place that holds a particle on its way between two points, the caller's or the border's, whichever comes
  /// first. `step_begin` is where it was before the step, of which the way may be the second part.
  std::optional<Vec3> on_path(const Vec3& step_begin, const Vec3& from, const Vec3& to) const;

 private:
  Vec3 point_in(const BorderHit& hit, const Vec3& step_begin, const Vec3& way) const;

  const Grid grid_;
  const StopVoxel options_;
  const BorderPath path_;
  const BorderPlanes* const planes_;
  const OwnStop& own_;
};

}  // namespace dynasurf::dynamics
