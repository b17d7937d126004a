#include "dynasurf/ventricle/measures/detail/wall_map.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/intensity.hpp"

namespace dynasurf::ventricle {
namespace {

/// Thickness at a hit from the triangle's corners; corners without a ray are left out.
std::optional<double> thickness_at(const mesh::RayHit& hit, const TriMesh& mesh, const VertexThickness& thickness) {
  const auto& t = mesh.triangles[hit.triangle];
  const double share[] = {1 - hit.u - hit.v, hit.u, hit.v};
  double sum = 0, weight = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const ThicknessSource source = thickness.source[t[c]];
    if (source == ThicknessSource::lid || source == ThicknessSource::nearest) continue;
    const double w = std::max(0.0, share[c]);
    sum += w * thickness.mm[t[c]], weight += w;
  }
  return weight > 1e-9 ? std::optional(sum / weight) : std::nullopt;
}

/// Uptake at a hit, from the triangle's corners.
double uptake_at(const mesh::RayHit& hit, const TriMesh& mesh, const std::vector<double>& uptake) {
  const auto& t = mesh.triangles[hit.triangle];
  return (1 - hit.u - hit.v) * uptake[t[0]] + hit.u * uptake[t[1]] + hit.v * uptake[t[2]];
}

/// The brightest place of the wall along a ray.
double brightest(const Image& image, const Vec3& origin, const Vec3& direction, double from, double to) {
  constexpr double step_mm = 1;
  const Vec3 start = to_grid(image.grid, origin), way = image.grid.direction.transpose() * direction;
  const int steps = std::max(1, ceil_int((to - from) / step_mm));
  double best = -std::numeric_limits<double>::infinity();
  for (int n = 0; n <= steps; ++n)
    best = std::max(best, image::sample_cubic(image, start + (from + (to - from) * n / steps) * way));
  return best;
}

/// Close to the valve plane the blur mixes the wall with what lies above it, more or less as the plane moves: samples
/// there take the counts of the ring below.
void lower_counts(WallMap& map, const HeartAxes& axes) {
  constexpr double blurred_mm = 6;  // half of a usual width of the blur
  for (int ring = 1; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector) {
      const std::size_t n = map.grid.index(ring, sector);
      if (map.endo[n] && map.epi[n] && axes.above_base((*map.endo[n] + *map.epi[n]) / 2) > -blurred_mm)
        if (const auto& below = map.counts[map.grid.index(ring - 1, sector)]) map.counts[n] = below;
    }
}

/// Area that a sample stands for, from the middle of the wall's distance to the axis or the centre.
double area_of(const PolarGrid& grid, const PolarPoint& at, double radius_mm, const HeartAxes& axes) {
  const double around = 2 * M_PI / grid.sectors, ring = 1.0 / grid.rings;
  if (at.rho < 0.5) return radius_mm * radius_mm * own::sin(at.rho * 180 * degrees) * (ring * 180 * degrees) * around;
  return radius_mm * around * (2 * ring * (axes.base() - axes.centre()).dot(axes.axis));
}

/// Mean distance of the wall from the axis where it is seen square to it: for valve planes that lean.
double usual_radius(const mesh::RayBvh& endo, const mesh::RayBvh& epi, const HeartAxes& axes, const PolarGrid& grid) {
  double sum = 0;
  int count = 0;
  for (int s = 0; s < grid.sectors; ++s) {
    const WallRay ray = axes.ray({0.75, (s + 0.5) * 360 / grid.sectors}, 0);
    const auto a = endo.first_hit(ray.origin, ray.direction), b = epi.first_hit(ray.origin, ray.direction);
    if (a && b) sum += (a->distance + b->distance) / 2, ++count;
  }
  return count > 0 ? sum / count : 0;
}

constexpr double lid_mm = 0.05;

WallMap empty_map(const PolarGrid& grid) {
  WallMap map;
  map.grid = grid;
  map.endo.resize(grid.size()), map.epi.resize(grid.size()), map.outwards.resize(grid.size());
  map.counts.resize(grid.size()), map.uptake.resize(grid.size());
  map.thickness_mm.resize(grid.size()), map.area_mm2.assign(grid.size(), 0.0);
  return map;
}

}  // namespace

WallMap map_wall(const mesh::TracedSurface& endo, const mesh::TracedSurface& epi, const WallUptake& uptake,
                 const WallThickness& thickness, const HeartAxes& axes, const Image& image, const PolarGrid& grid) {
  const double radius = usual_radius(endo.rays, epi.rays, axes, grid);
  WallMap map = empty_map(grid);
  parallel_for(grid.size(), grid.sectors, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const WallRay ray = axes.ray(grid.point(n), radius);
      map.outwards[n] = ray.direction;
      const auto inner = endo.rays.first_hit(ray.origin, ray.direction);
      const auto outer = epi.rays.first_hit(ray.origin, ray.direction);
      if (!inner || !outer) continue;
      const Vec3 a = ray.origin + inner->distance * ray.direction, b = ray.origin + outer->distance * ray.direction;
      if (axes.above_base(a) > -lid_mm || axes.above_base(b) > -lid_mm) continue;
      map.endo[n] = a, map.epi[n] = b;
      const auto [from, to] = std::minmax(inner->distance, outer->distance);
      map.counts[n] = brightest(image, ray.origin, ray.direction, from, to);
      if (uptake.endo && uptake.epi)
        map.uptake[n] = (uptake_at(*inner, endo.mesh, *uptake.endo) + uptake_at(*outer, epi.mesh, *uptake.epi)) / 2;
      map.area_mm2[n] = area_of(grid, grid.point(n), (from + to) / 2, axes);
      const auto from_endo = thickness_at(*inner, endo.mesh, thickness.endo);
      const auto from_epi = thickness_at(*outer, epi.mesh, thickness.epi);
      if (from_endo && from_epi)
        map.thickness_mm[n] = (*from_endo + *from_epi) / 2;
      else
        map.thickness_mm[n] = from_endo ? from_endo : from_epi;
    }
  });
  lower_counts(map, axes);
  return map;
}

WallMap map_cavity(const mesh::TracedSurface& endo, const HeartAxes& axes, const PolarGrid& grid) {
  const double radius = usual_radius(endo.rays, endo.rays, axes, grid);
  WallMap map = empty_map(grid);
  for (std::size_t n = 0; n < grid.size(); ++n) {
    const WallRay ray = axes.ray(grid.point(n), radius);
    map.outwards[n] = ray.direction;
    const auto hit = endo.rays.first_hit(ray.origin, ray.direction);
    if (!hit) continue;
    const Vec3 p = ray.origin + hit->distance * ray.direction;
    if (axes.above_base(p) > -lid_mm) continue;
    map.endo[n] = p;
    map.area_mm2[n] = area_of(grid, grid.point(n), hit->distance, axes);
  }
  return map;
}

PolarValues segment_means(SegmentModel model, const PolarGrid& grid, const PolarValues& values,
                          const std::vector<double>& weight) {
  const std::size_t count = segments_of(model).size();
  std::vector<double> sum(count, 0.0), total(count, 0.0);
  for (std::size_t n = 0; n < values.size(); ++n) {
    const int segment = segment_at(model, grid.point(n));
    if (!values[n] || segment == 0) continue;
    sum[segment - 1] += weight[n] * *values[n];
    total[segment - 1] += weight[n];
  }
  PolarValues means(count);
  for (std::size_t s = 0; s < count; ++s)
    if (total[s] > 0) means[s] = sum[s] / total[s];
  return means;
}

PolarValues on_vertices(const PolarGrid& grid, const PolarValues& values, const HeartAxes& axes,
                        const std::vector<Vec3>& vertices) {
  PolarValues result(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (axes.above_base(vertices[v]) > -0.1) continue;
    const PolarPoint at = axes.polar(vertices[v]);
    const double r = std::clamp(at.rho * grid.rings - 0.5, 0.0, grid.rings - 1.0);
    const double s = at.angle_deg * grid.sectors / 360 - 0.5 + grid.sectors;
    const int r0 = r, s0 = s;
    double sum = 0, total = 0;
    for (int dr = 0; dr < 2; ++dr)
      for (int ds = 0; ds < 2; ++ds) {
        const auto& value = values[grid.index(std::min(r0 + dr, grid.rings - 1), (s0 + ds) % grid.sectors)];
        const double share = (dr ? r - r0 : 1 - (r - r0)) * (ds ? s - s0 : 1 - (s - s0));
        if (value) sum += share * *value, total += share;
      }
    if (total > 1e-6) result[v] = sum / total;
  }
  return result;
}

}  // namespace dynasurf::ventricle
