#pragma once
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/heart/detail/lv_shell.hpp"

namespace dynasurf::heart {

/// The plane of the mitral valve, where the ventricle ends. Frame: that of what it was made from.
struct BasePlane {
  Vec3 point{0, 0, 0};   // where the long axis meets the plane
  Vec3 normal{0, 0, 1};  // unit, out of the ventricle
  double spread_mm = 0;  // median distance of the ends of the wall from the plane
  double seen = 0;       // share of the directions around the axis in which the wall's end was seen
  double cut = 0;        // share of the directions in which the volume ends before the wall

  double height(const Vec3& p) const { return (p - point).dot(normal); }
};

/// The same plane in another frame.
BasePlane to_world(const Grid& grid, BasePlane plane);
BasePlane to_grid(const Grid& grid, BasePlane plane);

/// How bright the wall is along one meridian of a cup, from the height `low` over its centre upwards in steps of 1.5
/// mm, as far as the volume goes.
struct Meridian {
  Vec3 out{1, 0, 0};  // square to the axis, unit
  double low = 0;     // mm
  std::vector<double> brightness;
  bool is_cut = false;  // the volume ends before the way does
};

/// What one image shows of the wall around a cup. Grid frame.
struct WallProfiles {
  LvShell cup;
  std::vector<Meridian> meridians;
  double typical = 0;     // brightness of a usual one
  double background = 0;  // of what surrounds the heart, without its neighbours

  /// How much brighter the middle of the wall is than what surrounds the heart, in units of the image.
  double over_surroundings() const { return typical - background; }
};
/// Looks along all meridians of a cup.
WallProfiles look_at_wall(const Image& image, const LvShell& cup);

/// The valve plane of one image: along every meridian of the cup the wall ends where it has fallen to `level_share` of
/// its brightness over that of the surroundings (a half: blur does not move the end of a wall of even thickness), and a
/// plane is laid through the ends, robust against hot neighbours and missing walls, its tilt held near square to the
/// axis. Grid frame. Absent when the end of the wall is seen in less than a third of the directions.
std::optional<BasePlane> find_base_plane(const WallProfiles& wall, double level_share = 0.5);

/// The planes of a whole cycle: height along the axis as a constant and two waves (three from 12 gates on), the tilt
/// common to all gates. Gates without a plane, or far from what their neighbours say, follow the others; `outlier`
/// tells which. Gates need not all have a plane, but half of them must; absent otherwise. All planes lie in one frame.
struct PlaneCycle {
  std::vector<BasePlane> planes;
  std::vector<bool> outlier;
};
/// Smooths the planes of all gates; `axis` is the long axis, a unit vector out of the base.
std::optional<PlaneCycle> smooth_over_cycle(std::span<const std::optional<BasePlane>> planes, const Vec3& axis);

/// The part of a closed surface below the plane, closed by the plane: what sticks out is laid flat on it. The same
/// triangles, still closed; right for surfaces whose part above the plane stands over their cut, as hearts do.
TriMesh flatten_above(TriMesh mesh, const BasePlane& plane);

/// How far the wall's end at the base of a cup moves outwards while the wall brightens, mm from one end of its way to
/// the other. Muscle that thickens looks brighter through a blur, and in systole all of the wall moves towards the
/// apex: below 0 in a heart whose apex is that of the cup, above 0 where it is at the other end. Grid frame. Absent
/// unless the end is seen in three quarters of the gates, and in six.
std::optional<double> outward_motion_mm(std::span<const Image> gates, const LvShell& cup);

}  // namespace dynasurf::heart
