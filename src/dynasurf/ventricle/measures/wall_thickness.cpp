#include "dynasurf/ventricle/measures/detail/wall_thickness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/detail/vertex_normals.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr std::size_t grain = 128;

/// Triangles that close the surface at the base: all corners on the valve plane.
std::vector<bool> wall_triangles(const TriMesh& mesh, const HeartAxes& axes) {
  constexpr double on_plane_mm = 0.05;
  std::vector<bool> is_wall;
  is_wall.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    is_wall.push_back(std::any_of(t.begin(), t.end(),
                                  [&](std::uint32_t v) { return axes.above_base(mesh.vertices[v]) < -on_plane_mm; }));
  return is_wall;
}

/// A third of the area of the wall's triangles around each vertex, mm2.
std::vector<double> areas_of_vertices(const TriMesh& mesh, const std::vector<bool>& is_wall) {
  std::vector<double> areas(mesh.vertices.size(), 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!is_wall[t]) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    const double area = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 6;
    for (const auto v : {a, b, c}) areas[v] += area;
  }
  return areas;
}

/// One surface of the wall, ready to be asked from the other.
struct Side {
  const TriMesh& mesh;
  const mesh::RayBvh& rays;
  std::vector<bool> is_wall;
  mesh::ClosestPoint nearest;

  Side(const mesh::TracedSurface& surface, const HeartAxes& axes)
      : mesh(surface.mesh), rays(surface.rays), is_wall(wall_triangles(mesh, axes)), nearest(mesh) {}
};

/// From the vertices of one side to the other. `outwards`: +1 from endo to epi, -1 from epi to endo.
VertexThickness thickness_from(const Side& side, const Side& other, const HeartAxes& axes, double outwards,
                               double lid_mm, double reach_mm) {
  const TriMesh& mesh = side.mesh;
  const std::vector<Vec3> normals = mesh::vertex_normals(mesh, side.is_wall);
  const std::size_t count = mesh.vertices.size();
  VertexThickness result{std::vector<double>(count, 0.0), std::vector<ThicknessSource>(count, ThicknessSource::lid)};
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3& p = mesh.vertices[v];
      if (axes.above_base(p) > -lid_mm || normals[v].isZero()) continue;
      const Vec3 direction = outwards * normals[v];
      const auto hit = other.rays.first_hit(p, direction, 0, reach_mm);
      // From between the surfaces the epicardium is met from behind and the endocardium from in front.
      if (hit && other.is_wall[hit->triangle] && hit->from_behind == (outwards > 0)) {
        result.mm[v] = hit->distance, result.source[v] = ThicknessSource::ray;
        continue;
      }
      const double nearest = std::sqrt(other.nearest(p).distance2);
      // A vertex beyond the other surface has it at its back, from the wrong side.
      const auto back = other.rays.first_hit(p, -direction, 0, reach_mm);
      const bool is_crossing = back && other.is_wall[back->triangle] && back->from_behind != (outwards > 0);
      result.mm[v] = is_crossing ? -nearest : nearest;
      result.source[v] = is_crossing ? ThicknessSource::crossing : ThicknessSource::nearest;
    }
  });
  return result;
}

struct Sums {
  double area = 0, first = 0, second = 0;
  void add(double weight, double value) { area += weight, first += weight * value, second += weight * value * value; }
  double mean() const { return first / area; }
};

std::optional<ThicknessSummary> summarise(const WallThickness& wall, const std::vector<double>& endo_areas,
                                          const std::vector<double>& epi_areas) {
  ThicknessSummary summary;
  summary.min_mm = std::numeric_limits<double>::infinity(), summary.max_mm = -summary.min_mm;
  Sums of[2];
  const VertexThickness* sides[] = {&wall.endo, &wall.epi};
  const std::vector<double>* areas[] = {&endo_areas, &epi_areas};
  for (int side = 0; side < 2; ++side)
    for (std::size_t v = 0; v < sides[side]->mm.size(); ++v) {
      const ThicknessSource source = sides[side]->source[v];
      summary.nearest += source == ThicknessSource::nearest;
      summary.crossing += source == ThicknessSource::crossing;
      if (source != ThicknessSource::ray) continue;
      const double mm = sides[side]->mm[v];
      of[side].add((*areas[side])[v], mm);
      summary.min_mm = std::min(summary.min_mm, mm), summary.max_mm = std::max(summary.max_mm, mm);
    }
  if (!(of[0].area > 0) || !(of[1].area > 0)) return std::nullopt;
  summary.from_endo_mm = of[0].mean(), summary.from_epi_mm = of[1].mean();
  // Both directions count alike, though the outer surface is the larger one.
  summary.mean_mm = (summary.from_endo_mm + summary.from_epi_mm) / 2;
  const double square = (of[0].second / of[0].area + of[1].second / of[1].area) / 2;
  summary.sd_mm = std::sqrt(std::max(0.0, square - summary.mean_mm * summary.mean_mm));
  return summary;
}

}  // namespace

WallThickness wall_thickness(const mesh::TracedSurface& endo, const mesh::TracedSurface& epi, const HeartAxes& axes,
                             double lid_mm, double reach_mm) {
  const Side inner(endo, axes), outer(epi, axes);
  WallThickness wall;
  wall.endo = thickness_from(inner, outer, axes, 1, lid_mm, reach_mm);
  wall.epi = thickness_from(outer, inner, axes, -1, lid_mm, reach_mm);
  wall.summary =
      summarise(wall, areas_of_vertices(inner.mesh, inner.is_wall), areas_of_vertices(outer.mesh, outer.is_wall));
  return wall;
}

}  // namespace dynasurf::ventricle
