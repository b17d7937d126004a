#include "dynasurf/mesh/surface_motion.hpp"

#include <cmath>
#include <string>

#include <Eigen/LU>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/ray_tree.hpp"

namespace dynasurf {
namespace {

std::vector<double> areas_around(const TriMesh& mesh) {
  std::vector<double> areas(mesh.vertices.size(), 0.0);
  for (const auto& [a, b, c] : mesh.triangles) {
    const double area = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 2;
    for (const auto v : {a, b, c}) areas[v] += area;
  }
  return areas;
}

void check(std::span<const Vec3> rest, std::span<const Vec3> now) {
  if (rest.size() != now.size())
    throw InputError("move_with_points: " + std::to_string(rest.size()) + " points at rest and " +
                     std::to_string(now.size()) + " moved; expected as many");
  if (rest.size() < 4)
    throw InputError("move_with_points: " + std::to_string(rest.size()) + " points; expected at least 4");
  for (std::size_t n = 0; n < rest.size(); ++n)
    if (!rest[n].allFinite() || !now[n].allFinite())
      throw InputError("move_with_points: point " + std::to_string(n + 1) + " is not finite");
}

}  // namespace

SurfaceMotion surface_motion(const TriMesh& rest, const TriMesh& now) {
  if (rest.vertices.size() != now.vertices.size() || rest.triangles != now.triangles)
    throw InputError("surface_motion: the meshes have different triangles; expected the same ones");
  SurfaceMotion motion;
  const std::vector<double> before = areas_around(rest), after = areas_around(now);
  const std::vector<Vec3> outwards = normals_of_vertices(rest);
  for (std::size_t v = 0; v < rest.vertices.size(); ++v) {
    motion.displacement_mm.push_back((now.vertices[v] - rest.vertices[v]).norm());
    motion.inward_mm.push_back((rest.vertices[v] - now.vertices[v]).dot(outwards[v]));
    motion.area_strain_percent.push_back(before[v] > 0 ? 100 * (after[v] / before[v] - 1) : 0);
  }
  return motion;
}

TriMesh move_with_points(TriMesh mesh, std::span<const Vec3> rest, std::span<const Vec3> now, double smoothing) {
  check(rest, now);
  const auto n = static_cast<Eigen::Index>(rest.size());
  const auto at = [](Eigen::Index i) { return static_cast<std::size_t>(i); };
  // Lengths near 1 keep the system well scaled.
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : rest) middle += p / static_cast<double>(n);
  double size = 0;
  for (const Vec3& p : rest) size = std::max(size, (p - middle).norm());
  const auto scaled = [&](const Vec3& p) -> Vec3 { return (p - middle) / size; };

  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 4, n + 4), moves = Eigen::MatrixXd::Zero(n + 4, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) system(i, j) = (scaled(rest[at(i)]) - scaled(rest[at(j)])).norm();
    system(i, i) -= smoothing * size;  // |r| is conditionally negative
    system(i, n) = system(n, i) = 1;
    system.block<1, 3>(i, n + 1) = scaled(rest[at(i)]).transpose();
    system.block<3, 1>(n + 1, i) = scaled(rest[at(i)]);
    moves.row(i) = (now[at(i)] - rest[at(i)]).transpose();
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> factor(system);
  if (!factor.isInvertible())
    throw InputError("move_with_points: the points lie in one plane or some are equal; expected points in space");
  const Eigen::MatrixXd weights = factor.solve(moves);
  for (Vec3& p : mesh.vertices) {
    const Vec3 q = scaled(p);
    Vec3 move = weights.row(n).transpose() + weights.bottomRows<3>().transpose() * q;
    for (Eigen::Index i = 0; i < n; ++i) move += (q - scaled(rest[at(i)])).norm() * weights.row(i).transpose();
    p += move;
  }
  return mesh;
}

double rotation_deg(std::span<const Vec3> rest, std::span<const Vec3> now, const Vec3& on_axis, const Vec3& axis,
                    double low, double high) {
  double sine = 0, cosine = 0;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const double height = (rest[v] - on_axis).dot(axis);
    if (height < low || height > high) continue;
    const Vec3 a = rest[v] - on_axis - height * axis;
    const Vec3 b = now[v] - on_axis - (now[v] - on_axis).dot(axis) * axis;
    sine += axis.dot(a.cross(b)), cosine += a.dot(b);
  }
  return std::atan2(sine, cosine) * 180 / M_PI;
}

}  // namespace dynasurf
