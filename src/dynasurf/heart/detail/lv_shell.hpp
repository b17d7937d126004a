#pragma once
#include <optional>
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::heart {

/// The middle of the ventricle's wall as an ellipsoid of revolution, open at the base: what is left of a heart when
/// everything but its place, its axis and its size is forgotten. Frame and unit: mm, that of the image it is used with.
struct LvShell {
  Vec3 centre{0, 0, 0};       // of the ellipsoid
  Vec3 axis{0, 0, 1};         // unit, from apex to base
  double radius_mm = 0;       // across the axis, to the middle of the wall
  double half_length_mm = 0;  // along the axis
  double base_mm = 0;         // height of the base plane above the centre, along the axis

  Vec3 apex() const { return centre - half_length_mm * axis; }
  Vec3 base() const { return centre + base_mm * axis; }
  /// Halfway between apex and base plane: the point that is called the centre of the heart.
  Vec3 middle() const { return centre + (base_mm - half_length_mm) / 2 * axis; }
};

/// Two unit vectors that make a right-handed frame with a unit axis.
struct ShellBasis {
  Vec3 u, v;
};
/// Two directions square to an axis and to each other, the same for the same axis.
ShellBasis across(const Vec3& axis);

/// A point of the ellipsoid at polar angle `theta` from the apex and `phi` around the axis, and its outward normal.
struct ShellPoint {
  Vec3 position, normal;
};
/// The point of a cup at two angles, rad.
ShellPoint on_cup(const LvShell& cup, const ShellBasis& a, double theta, double phi);

/// Polar angle at which the cup reaches its base plane.
double base_angle(const LvShell& cup);

/// Volume within the ellipsoid below its base plane, mm^3.
double volume_mm3(const LvShell& cup);

/// Distance of a point from the ellipsoid to first order: positive outside.
double signed_distance(const LvShell& cup, const Vec3& p);

/// The cup in the world's frame, and back.
LvShell to_world(const Grid& grid, LvShell cup);
LvShell to_grid(const Grid& grid, LvShell cup);

/// How well a cup lies in the wall. Directions around the axis see the wall as a ridge, darker inside and outside.
struct CupScore {
  double contrast = 0;    // wall less its sides and less what lies over the open base, in units of the image
  double brightness = 0;  // median of the wall
  double relative() const { return brightness > 0 ? contrast / brightness : 0; }
};
/// Looks at some 60 points of the cup and beside them; what is brighter than the wall elsewhere counts no more than
/// the wall (hot neighbours).
CupScore score(const Image& image, const LvShell& cup);

/// Moves, turns and resizes the cup by steps that halve down to `last_mm`, as long as its score rises. Its size stays
/// within what hearts have: radius 12 to 60 mm, length to radius 1 to 2.8.
LvShell local_search(const Image& image, LvShell cup, double step_mm, double last_mm = 0.7);

/// Share of the wall's outer side that lies outside the volume: 0 for a heart that is all in view. Grid frame.
double share_outside(const Grid& grid, const LvShell& cup);

/// A point of the middle of the wall, found as the brightest point along the cup's normal.
struct RidgePoint {
  Vec3 position{0, 0, 0};
  double brightness = 0;
  double prominence = 0;  // over the darker side within reach, 0: no ridge there
  double offset_mm = 0;   // from the cup, outwards positive
};
/// `around` points in each of `rows` rows from apex to base. A local maximum near the cup is preferred to a brighter
/// one farther away. Points outside the volume have no prominence.
std::vector<RidgePoint> find_ridge(const Image& image, const LvShell& cup, int rows, int around, double reach_mm);

/// The cup that lies nearest to the ridge points (robust least squares: Gauss-Newton with Tukey weights). The height of
/// the base stays. Absent when fewer than 12 points or no solution.
std::optional<LvShell> fit_cup(const std::vector<RidgePoint>& ridge, const LvShell& start);

}  // namespace dynasurf::heart
