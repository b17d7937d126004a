#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/detail/point_spline.hpp"
#include "dynasurf/mesh/detail/vertex_normals.hpp"
#include "dynasurf/mesh/motion.hpp"

namespace dynasurf::mesh {
namespace {

std::vector<double> areas_around(const TriMesh& mesh) {
  std::vector<double> areas(mesh.vertices.size(), 0.0);
  for (const auto& [a, b, c] : mesh.triangles) {
    const double area = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 2;
    for (const auto v : {a, b, c}) areas[v] += area;
  }
  return areas;
}

}  // namespace

SurfaceMotion surface_motion(const TriMesh& rest, const TriMesh& now) {
  if (rest.vertices.size() != now.vertices.size() || rest.triangles != now.triangles)
    throw InputError("surface_motion: the meshes have different triangles; expected the same ones");
  SurfaceMotion motion;
  const std::vector<double> before = areas_around(rest), after = areas_around(now);
  const std::vector<Vec3> outwards = vertex_normals(rest);
  for (std::size_t v = 0; v < rest.vertices.size(); ++v) {
    motion.displacement_mm.push_back((now.vertices[v] - rest.vertices[v]).norm());
    motion.inward_mm.push_back((rest.vertices[v] - now.vertices[v]).dot(outwards[v]));
    motion.area_strain_percent.push_back(before[v] > 0 ? 100 * (after[v] / before[v] - 1) : 0);
  }
  return motion;
}

TriMesh move_with_points(TriMesh mesh, std::span<const Vec3> rest, std::span<const Vec3> now, double smoothing) {
  const SplineMotion motion = PointSpline(rest, smoothing).motion_to(now);
  for (Vec3& p : mesh.vertices) p = motion.at(p);
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
  return own::atan2(sine, cosine) * 180 / M_PI;
}

}  // namespace dynasurf::mesh
