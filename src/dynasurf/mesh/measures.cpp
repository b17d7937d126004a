#include "dynasurf/mesh/measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::mesh {
namespace {

struct Corners {
  const Vec3 &a, &b, &c;
};

Corners corners_of(const TriMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

double angle_between(const Vec3& u, const Vec3& v) { return own::atan2(u.cross(v).norm(), u.dot(v)); }

/// Mean and extremes of one number per triangle.
struct Summary {
  double sum = 0, min = std::numeric_limits<double>::infinity(), max = 0;
  void add(double x) {
    sum += x;
    min = std::min(min, x);
    max = std::max(max, x);
  }
};

}  // namespace

double volume_mm3(const TriMesh& mesh) {
  double six_volumes = 0;
  for (const auto& t : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, t);
    six_volumes += a.dot((b - a).cross(c - a));  // equals a.(b x c), and loses fewer digits far from the origin
  }
  return six_volumes / 6;
}

double volume_mm3_quadrature(const TriMesh& mesh) {
  // Thesis eq. 5.10: barycentric points (rows, in 15ths) and their weights. The points are not the standard ones of
  // degree 3, but x.n is linear on a flat triangle, so every rule whose weights sum to 1/2 about the centroid is exact.
  static constexpr double kPoints[4][3] = {{5, 5, 5}, {11, 2, 2}, {2, 11, 2}, {2, 2, 11}};
  static constexpr double kWeights[4] = {-27.0 / 96, 25.0 / 96, 25.0 / 96, 25.0 / 96};
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, t);
    const Vec3 normal = (b - a).cross(c - a);  // length 2 A: the weights expect it so (E36)
    for (int l = 0; l < 4; ++l) {
      const Vec3 p = (kPoints[l][0] * a + kPoints[l][1] * b + kPoints[l][2] * c) / 15;
      volume += kWeights[l] * p.dot(normal) / 3;
    }
  }
  return volume;
}

double area_mm2(const TriMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, t);
    area += (b - a).cross(c - a).norm() / 2;
  }
  return area;
}

TriangleQuality triangle_quality(const TriMesh& mesh) {
  TriangleQuality q;
  if (mesh.triangles.empty()) return q;
  Summary area, d, shape;
  double smallest_angle = std::numbers::pi;
  for (const auto& t : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, t);
    const Vec3 ab = b - a, bc = c - b, ca = a - c;
    const double A = ab.cross(ca).norm() / 2;
    const double longest = std::sqrt(std::max({ab.squaredNorm(), bc.squaredNorm(), ca.squaredNorm()}));
    const double squares = ab.squaredNorm() + bc.squaredNorm() + ca.squaredNorm();
    area.add(A);
    d.add(longest > 0 ? A / longest : 0);
    shape.add(squares > 0 ? 4 * std::numbers::sqrt3 * A / squares : 0);
    smallest_angle = std::min({smallest_angle, angle_between(ab, -ca), angle_between(bc, -ab), angle_between(ca, -bc)});
  }
  const double count = mesh.triangles.size();
  q.area_mean = area.sum / count, q.area_min = area.min, q.area_max = area.max;
  q.d_mean = d.sum / count, q.d_min = d.min, q.d_max = d.max;
  q.shape_mean = shape.sum / count, q.shape_min = shape.min;
  q.smallest_angle_deg = smallest_angle * 180 / std::numbers::pi;
  return q;
}

}  // namespace dynasurf::mesh
