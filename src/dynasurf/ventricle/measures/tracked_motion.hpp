#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/point_cloud.hpp"

namespace dynasurf::ventricle {

/// The ventricle's long axis at rest, world, mm: its end at the apex and its end at the valve plane, and how well the
/// distance between them is known (a standard deviation).
struct LongAxis {
  Vec3 apex{0, 0, 0}, base{0, 0, 1};
  double length_sd_mm = 0;
};

/// Thirds of the long axis.
enum class WallLevel { apex, mid, base };
inline std::span<const std::string_view> names_of(WallLevel) {
  static constexpr std::array<std::string_view, 3> names{"apex", "mid", "base"};
  return names;
}

/// Mean strains (change of length over length) along the directions of a cylinder about the long axis.
struct Strains {
  double radial_percent = 0, circumferential_percent = 0, longitudinal_percent = 0;
};

/// How the points of one level moved from rest to a gate.
struct LevelMotion {
  int points = 0;
  double height_mm = 0;     // above the apex at rest, mean weighted as the rotation is
  double rotation_deg = 0;  // about the middle of its points, counter-clockwise seen from the apex
  Strains strains;
};

/// How the heart moved from rest to a gate.
struct GateMotion {
  std::array<std::optional<LevelMotion>, 3> levels;  // by WallLevel; absent where a level has fewer than 3 points
  double twist_deg = 0, twist_sd_deg = 0;
  double torsion_deg_per_cm = 0;
  Strains strains;  // of all points
};

/// How the heart moved through the beat.
struct TrackedMotion {
  std::vector<GateMotion> gates;
  int rest_gate = 0;      // 0-based
  int peak_gate = 0;      // of the largest twist, whatever its sense
  double length_mm = 0;   // of the long axis at rest
  double spacing_mm = 0;  // median distance of a point from the nearest other one, at rest
};

/// Twist and strain from tracked points (FUT-TAGGED): what no surface shows by itself. The rotation of every point
/// about the middle of its level, weighted by the square of its distance from the axis, is fitted by a line over the
/// height; *torsion* is the line's slope and *twist* what it gains from the valve plane to the apex, positive where
/// the apex turns counter-clockwise against the base, seen from the apex. Its standard deviation follows from how far
/// the points lie from the line, and from that of the axis's length. Strains come from the spline that moves all points
/// (PointSpline), at the points: across the wall they are too small unless points lie much closer to each other than
/// the wall is thick. Heights count at rest: a point stays in its level. Throws InputError for fewer than 12 points,
/// points in fewer than two levels, an axis without length, and what PointSpline refuses; OptionError for a gate that
/// does not exist.
TrackedMotion measure_motion(const TrackedPoints& points, const LongAxis& axis, int rest_gate = 0);

}  // namespace dynasurf::ventricle
