#pragma once
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/ventricle/measures/detail/heart_axes.hpp"

namespace dynasurf::ventricle {

/// How the wall is divided. `aha17`: six basal, six mid, four apical segments and the apex (Cerqueira 2002).
/// `segments20`: six distal, six mid, six basal, an anterior and an inferior half of the apex.
enum class SegmentModel { aha17, segments20 };
inline std::span<const std::string_view> names_of(SegmentModel) {
  static constexpr std::array<std::string_view, 2> names{"aha17", "segments20"};
  return names;
}

/// A segment as a piece of the polar map: from `rho_low` to `rho_high`, `width_deg` wide about `middle_deg`.
struct Segment {
  int number = 0;                    // from 1
  std::string_view name, territory;  // territory: LAD, RCA or LCX, the coronary artery that usually feeds it
  double rho_low = 0, rho_high = 1, middle_deg = 0, width_deg = 360;
};
/// All segments of a model, by their numbers.
std::span<const Segment> segments_of(SegmentModel model);

/// Number of the segment at a polar point, from 1. A point on a common border belongs to the outer ring and to the
/// sector that begins there; above the valve plane it is 0: no segment.
int segment_at(SegmentModel model, const PolarPoint& at);

/// The segment of every vertex; 0 for those on the lid or above the valve plane (`slack_mm` below it counts as lid).
std::vector<int> segments_of_vertices(SegmentModel model, const HeartAxes& axes, std::span<const Vec3> vertices,
                                      double slack_mm = 0.1);

}  // namespace dynasurf::ventricle
