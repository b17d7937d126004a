#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/mesh/detail/ray_bvh.hpp"

namespace dynasurf::ventricle {

/// Who says where the anterior wall is.
enum class AnteriorRule { automatic, patient, rows };
inline std::span<const std::string_view> names_of(AnteriorRule) {
  static constexpr std::array<std::string_view, 3> names{"auto", "patient", "rows"};
  return names;
}

/// The anterior direction, square to the long axis (unit, apex to base; world frame, LPS), and which rule gave it.
/// `patient`: as near to the patient's head as square to the axis allows, which is how short-axis slices are cut;
/// `rows`: against the rows of the short-axis stack `grid`, whose first row is shown on top.
/// `automatic` takes `patient` while the axis runs as in a patient (apex to the left, in front and below, within 50
/// degrees of the mean), else `rows`: arrays without an orientation have axes of no meaning.
struct Anterior {
  Vec3 direction{0, 0, 1};
  AnteriorRule rule = AnteriorRule::rows;
};
/// Looks for it by a rule.
Anterior find_anterior(const Vec3& axis, const Grid& grid, AnteriorRule rule);

/// Place on the wall as on a polar map: `rho` 0 at the apex, 1 at the valve plane; `angle_deg` seen from the apex,
/// counter-clockwise from the lateral wall: 0 lateral, 90 anterior, 180 septal, 270 inferior, in [0, 360).
struct PolarPoint {
  double rho = 0, angle_deg = 0;
};

/// A ray across the wall.
struct WallRay {
  Vec3 origin{0, 0, 0}, direction{0, 0, 1};
};

/// The frame in which the wall of one gate is mapped. World frame.
///
/// The upper two thirds of the axis see the wall square to the axis, the lowest third from its upper end in all
/// directions, as maps of perfusion have long been sampled: a cylinder on half a sphere. `rho` is 1/2 between them and
/// grows evenly with the angle below, with the height above, so that the rings of the segments end at 1/4, 1/2, 3/4, 1.
struct HeartAxes {
  Vec3 apex{0, 0, 0};         // on the axis, in the middle of the wall
  Vec3 axis{0, 0, 1};         // unit, to the base
  Vec3 anterior{0, 1, 0};     // unit, square to the axis
  double length_mm = 0;       // from `apex` to the valve plane, along the axis
  Vec3 base_normal{0, 0, 1};  // unit, out of the ventricle

  Vec3 lateral() const { return axis.cross(anterior); }
  Vec3 centre() const { return apex + length_mm / 3 * axis; }  // of the half sphere
  Vec3 base() const { return apex + length_mm * axis; }
  /// Height of a point above the valve plane; negative in the ventricle.
  double above_base(const Vec3& p) const { return (p - base()).dot(base_normal); }
  PolarPoint polar(const Vec3& p) const;
  /// The ray that sees the wall at a polar point; `radius_mm`: distance of the wall from the axis there, which matters
  /// only where the valve plane leans.
  WallRay ray(const PolarPoint& at, double radius_mm) const;
};

/// The frame of one gate from its closed surfaces. `on_axis`: a point of the long axis inside the cavity. Without a
/// valve plane the ventricle ends where the lower of the two surfaces does. Absent when the axis does not leave both
/// surfaces at the apex, or the ventricle has no length.
std::optional<HeartAxes> axes_of(const mesh::TracedSurface& endo, const mesh::TracedSurface& epi, const Vec3& on_axis,
                                 const Vec3& axis, const Vec3& anterior, const std::optional<heart::BasePlane>& plane);

}  // namespace dynasurf::ventricle
