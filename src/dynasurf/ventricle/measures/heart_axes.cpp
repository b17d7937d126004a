#include "dynasurf/ventricle/measures/detail/heart_axes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double sphere_part = 1.0 / 3;  // of the axis that is seen from one point

Vec3 square_to(const Vec3& axis, const Vec3& v) { return v - v.dot(axis) * axis; }

/// The mean direction from apex to base of hearts: to the right, back and up (azimuth 45, elevation 30 degrees).
bool lies_as_in_a_patient(const Vec3& axis) {
  const Vec3 usual(-own::cos(30 * degrees) * own::sin(45 * degrees), own::cos(30 * degrees) * own::cos(45 * degrees),
                   own::sin(30 * degrees));
  return axis.dot(usual) > own::cos(50 * degrees);
}

double highest(const TriMesh& mesh, const Vec3& from, const Vec3& axis) {
  double top = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : mesh.vertices) top = std::max(top, (p - from).dot(axis));
  return top;
}

}  // namespace

Anterior find_anterior(const Vec3& axis, const Grid& grid, AnteriorRule rule) {
  const Vec3 up = square_to(axis, Vec3(0, 0, 1)), against_rows = square_to(axis, -grid.direction.col(1));
  if (rule == AnteriorRule::automatic)
    rule = lies_as_in_a_patient(axis) || against_rows.norm() < 0.1 ? AnteriorRule::patient : AnteriorRule::rows;
  const Vec3 chosen = rule == AnteriorRule::patient ? up : against_rows;
  const Vec3 other = rule == AnteriorRule::patient ? against_rows : up;
  // An axis along the asked direction leaves nothing square to it.
  return {(chosen.norm() > 1e-6 ? chosen : other).normalized(), rule};
}

PolarPoint HeartAxes::polar(const Vec3& p) const {
  const Vec3 q = p - centre();
  const double x = q.dot(lateral()), y = q.dot(anterior), z = q.dot(axis);
  PolarPoint at;
  at.angle_deg = own::atan2(y, x) / degrees;
  if (at.angle_deg < 0) at.angle_deg += 360;
  if (at.angle_deg >= 360) at.angle_deg = 0;
  if (z < 0) {
    at.rho = 0.5 * own::atan2(own::hypot(x, y), -z) / (90 * degrees);
  } else {
    // The valve plane may lean: its height straight above the point counts.
    const double to_base = -above_base(p) / base_normal.dot(axis);
    at.rho = z + to_base > 0 ? 0.5 + 0.5 * z / (z + to_base) : 1;
  }
  return at;
}

WallRay HeartAxes::ray(const PolarPoint& at, double radius_mm) const {
  const double angle = at.angle_deg * degrees;
  const Vec3 outwards = own::cos(angle) * lateral() + own::sin(angle) * anterior;
  if (at.rho < 0.5) {
    const double from_apex = at.rho * 180 * degrees;
    return {centre(), own::sin(from_apex) * outwards - own::cos(from_apex) * axis};
  }
  const double base_height =
      (1 - sphere_part) * length_mm - radius_mm * outwards.dot(base_normal) / axis.dot(base_normal);
  return {centre() + (2 * at.rho - 1) * base_height * axis, outwards};
}

std::optional<HeartAxes> axes_of(const mesh::TracedSurface& endo, const mesh::TracedSurface& epi, const Vec3& on_axis,
                                 const Vec3& axis, const Vec3& anterior, const std::optional<heart::BasePlane>& plane) {
  const auto inner = endo.rays.first_hit(on_axis, -axis), outer = epi.rays.first_hit(on_axis, -axis);
  if (!inner || !outer) return std::nullopt;
  HeartAxes axes;
  axes.axis = axis;
  axes.anterior = square_to(axis, anterior).normalized();
  axes.apex = on_axis - (inner->distance + outer->distance) / 2 * axis;
  if (plane && plane->normal.dot(axis) > 0.5) {
    axes.base_normal = plane->normal;
    axes.length_mm = (plane->point - axes.apex).dot(plane->normal) / axis.dot(plane->normal);
  } else {
    axes.base_normal = axis;
    axes.length_mm = std::min(highest(endo.mesh, axes.apex, axis), highest(epi.mesh, axes.apex, axis));
  }
  if (!(axes.length_mm > 0)) return std::nullopt;
  return axes;
}

}  // namespace dynasurf::ventricle
