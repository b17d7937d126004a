#include "dynasurf/synthetic/detail/level_bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::synthetic {
namespace {

/// Two distances, negative inside, as one that has no crease within `width` of where they are equal.
double joined(double a, double b, double width) {
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - h * h * width / 4;
}
/// `a` without `b`.
double less(double a, double b, double width) { return -joined(-a, b, width); }

double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& half_axes) {
  const Vec3 q = (p - centre).cwiseQuotient(half_axes);
  const double near = q.norm(), slope = q.cwiseQuotient(half_axes).norm();
  return slope > 1e-12 ? near * (near - 1) / slope : -half_axes.minCoeff();
}

/// The thick line from a to b, whose radius changes on the way.
double limb(const Vec3& p, const Vec3& a, double radius_a, const Vec3& b, double radius_b) {
  const Vec3 way = b - a;
  const double t = std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (p - a - t * way).norm() - (radius_a + t * (radius_b - radius_a));
}

/// The left half of the space has what the right one has.
Vec3 on_the_right(const Vec3& p) { return {std::abs(p[0]), p[1], p[2]}; }

double ramp(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

double rabbit_level(const Vec3& p) {
  constexpr double soft = 0.08;
  const Vec3 q = on_the_right(p);
  double d = ellipsoid(p, {0, 0.05, -0.35}, {0.42, 0.55, 0.48});                        // trunk
  d = joined(d, ellipsoid(p, {0, -0.45, 0.25}, {0.25, 0.32, 0.27}), 2 * soft);          // head
  d = joined(d, limb(q, {0.12, -0.36, 0.42}, 0.1, {0.26, -0.12, 1.12}, 0.07), soft);    // ears
  d = joined(d, ellipsoid(q, {0.32, 0.2, -0.84}, {0.15, 0.34, 0.12}), soft);            // hind feet
  d = joined(d, limb(q, {0.18, -0.36, -0.3}, 0.12, {0.18, -0.46, -0.86}, 0.09), soft);  // front legs
  return -joined(d, ellipsoid(p, {0, 0.63, -0.5}, {0.16, 0.16, 0.16}), soft);           // tail
}

double screwdriver_level(const Vec3& p) {
  const double across = own::hypot(p[1], p[2]), x = p[0];
  const double waist = 0.2 - 0.05 * ramp(-0.45, -0.25, x) + 0.03 * ramp(-0.2, -0.12, x);
  const double flutes = 0.022 * own::cos(8 * own::atan2(p[2], p[1])) * ramp(0.05, 0.15, across) *
                        ramp(-1.12, -0.95, x) * (1 - ramp(-0.5, -0.35, x));
  const double ends = std::max(-1.1 - x, x + 0.08);  // the handle lies between two planes with rounded rims
  const double side = across - waist - flutes;
  double d = -joined(-side, -ends, 0.12);
  d = joined(d, limb(p, {-0.2, 0, 0}, 0.065, {0.95, 0, 0}, 0.065), 0.03);
  return -joined(d, ellipsoid(p, {1.02, 0, 0}, {0.2, 0.12, 0.035}), 0.04);  // blade
}

double venus_level(const Vec3& p) {
  const Vec3 q = on_the_right(p);
  double d = ellipsoid(p, {0, 0.02, -0.78}, {0.74, 0.36, 0.34});            // shoulders
  d = joined(d, ellipsoid(q, {0.27, -0.26, -0.9}, {0.2, 0.18, 0.2}), 0.1);  // breast
  d = joined(d, limb(p, {0, 0.05, -0.6}, 0.2, {0, 0, 0.1}, 0.17), 0.15);    // neck
  double head = ellipsoid(p, {0, -0.02, 0.48}, {0.32, 0.39, 0.45});
  head = joined(head, limb(p, {0, -0.38, 0.52}, 0.04, {0, -0.46, 0.36}, 0.065), 0.06);  // nose
  head = joined(head, ellipsoid(p, {0, -0.37, 0.22}, {0.1, 0.06, 0.035}), 0.04);        // lips
  head = less(head, ellipsoid(q, {0.13, -0.44, 0.5}, {0.08, 0.09, 0.05}), 0.04);        // eyes
  head = joined(head, ellipsoid(p, {0, 0.42, 0.58}, {0.19, 0.17, 0.18}), 0.08);         // knot of hair
  const double is_hair = ramp(-0.12, 0.02, p[1] + 0.3 * (p[2] - 0.5));
  head -= 0.014 * is_hair * own::sin(34 * p[2]) * own::cos(16 * own::atan2(p[0], p[1]));
  return -joined(d, head, 0.08);
}

double moai_level(const Vec3& p) {
  const Vec3 q = on_the_right(p);
  const double x = q[0] / 0.42, y = p[1] / 0.44, z = p[2] / 1.05, x2 = x * x, y2 = y * y, z2 = z * z;
  double d = 0.42 * (std::sqrt(std::sqrt(x2 * x2 + y2 * y2 + z2 * z2)) - 1);          // a rounded block
  d = joined(d, ellipsoid(p, {0, -0.42, 0.42}, {0.36, 0.12, 0.09}), 0.08);            // brow
  d = joined(d, limb(p, {0, -0.45, 0.38}, 0.06, {0, -0.58, -0.05}, 0.12), 0.06);      // nose
  d = joined(d, ellipsoid(p, {0, -0.44, -0.35}, {0.2, 0.1, 0.06}), 0.05);             // lips
  d = joined(d, ellipsoid(p, {0, -0.4, -0.64}, {0.28, 0.16, 0.14}), 0.08);            // chin
  d = joined(d, limb(q, {0.42, 0.02, 0.35}, 0.07, {0.42, 0.04, -0.38}, 0.08), 0.05);  // long ears
  return -less(d, ellipsoid(q, {0.19, -0.5, 0.26}, {0.1, 0.13, 0.08}), 0.05);         // sockets
}

double squirrel_level(const Vec3& p) {
  constexpr double soft = 0.06;
  const Vec3 q = on_the_right(p);
  double d = ellipsoid(p, {0, 0, -0.35}, {0.34, 0.37, 0.55});                        // trunk
  d = joined(d, ellipsoid(p, {0, -0.25, 0.4}, {0.26, 0.31, 0.26}), 2 * soft);        // head
  d = joined(d, limb(q, {0.16, -0.15, 0.6}, 0.08, {0.22, -0.1, 0.86}, 0.04), soft);  // ears
  d = joined(d, limb(q, {0.26, -0.2, 0}, 0.1, {0.22, -0.5, -0.12}, 0.08), soft);     // arms
  d = joined(d, ellipsoid(q, {0.24, -0.28, -0.86}, {0.14, 0.3, 0.11}), soft);        // feet
  struct Joint {
    Vec3 at;
    double radius;
  };
  const std::array<Joint, 5> tail{{{{0, 0.25, -0.78}, 0.14},
                                   {{0, 0.68, -0.62}, 0.2},
                                   {{0, 0.86, -0.02}, 0.24},
                                   {{0, 0.72, 0.55}, 0.22},
                                   {{0, 0.9, 0.95}, 0.13}}};
  for (std::size_t n = 0; n + 1 < tail.size(); ++n)
    d = joined(d, limb(p, tail[n].at, tail[n].radius, tail[n + 1].at, tail[n + 1].radius), soft);
  return -d;
}

}  // namespace dynasurf::synthetic
