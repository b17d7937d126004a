#include "dynasurf/ventricle/measures/wall_solid.hpp"

#include <algorithm>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/ray_tree.hpp"

namespace dynasurf {
namespace {

/// Triangles of a cap: a fan around vertex 0 (the apex), then rings. Counter-clockwise seen from outside, where angles
/// run counter-clockwise seen from the apex.
std::vector<std::array<std::uint32_t, 3>> cap_triangles(int rings, int sectors) {
  const auto vertex = [&](int ring, int sector) {
    return ring == 0 ? 0u : static_cast<std::uint32_t>(1 + (ring - 1) * sectors + sector % sectors);
  };
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (int s = 0; s < sectors; ++s) triangles.push_back({0u, vertex(1, s), vertex(1, s + 1)});
  for (int r = 1; r < rings; ++r)
    for (int s = 0; s < sectors; ++s) {
      triangles.push_back({vertex(r, s), vertex(r + 1, s), vertex(r + 1, s + 1)});
      triangles.push_back({vertex(r, s), vertex(r + 1, s + 1), vertex(r, s + 1)});
    }
  return triangles;
}

/// Both surfaces at the same polar points, inner first.
struct Sheets {
  TriMesh side[2];
  std::vector<int> ring;  // of every vertex
};

/// Absent where a ray misses a surface, the wall turns inside out, or its rim is not that of a wall: surfaces that end
/// below the valve plane are met there by their lids' dents only.
std::optional<Sheets> meet(const RayTree (&trees)[2], const HeartAxes& axes, const WallSolidSize& size) {
  // A ray in the valve plane runs along the lid: it looks a little below, and its point is moved back onto the plane.
  constexpr double far_mm = 300;
  constexpr double below_lid = 1e-4;  // of rho: some hundredths of a millimetre
  constexpr double least_rim = 0.5;   // radius of the outer rim over that at rho 3/4
  Sheets sheets;
  std::vector<double> middle(static_cast<std::size_t>(size.sectors), 0.0);
  for (int ring = 0; ring <= size.rings; ++ring)
    for (int sector = 0; sector < (ring == 0 ? 1 : size.sectors); ++sector) {
      const PolarPoint at{std::min(static_cast<double>(ring) / size.rings, 1 - below_lid),
                          360.0 * sector / size.sectors};
      double radii[2] = {0, 0};
      for (int side = 0; side < 2; ++side) {
        // Where the valve plane leans, a ray's height depends on how far out it meets the wall: thrice is enough.
        WallRay ray = axes.ray(at, 0);
        for (int pass = 0; pass < 3; ++pass) {
          ray = axes.ray(at, radii[side]);
          // From outside: a lid with a dent is met before the wall from within.
          const auto hit = trees[side].first_hit(ray.origin + far_mm * ray.direction, -ray.direction, 0, far_mm);
          if (!hit) return std::nullopt;
          radii[side] = far_mm - hit->distance;
        }
        Vec3 p = ray.origin + radii[side] * ray.direction;
        if (ring == size.rings) p -= axes.above_base(p) / axes.axis.dot(axes.base_normal) * axes.axis;
        sheets.side[side].vertices.push_back(p);
      }
      if (radii[1] <= radii[0]) return std::nullopt;
      double& usual = middle[static_cast<std::size_t>(sector)];
      if (4 * ring <= 3 * size.rings) usual = radii[1];
      if (ring == size.rings && radii[1] < least_rim * usual) return std::nullopt;
      sheets.ring.push_back(ring);
    }
  sheets.side[0].triangles = sheets.side[1].triangles = cap_triangles(size.rings, size.sectors);
  return sheets;
}

}  // namespace

std::optional<WallSolid> wall_solid(const TriMesh& endo, const TriMesh& epi, const HeartAxes& axes,
                                    const WallSolidSize& size) {
  if (size.rings < 2 || size.sectors < 3 || size.layers < 1)
    throw OptionError("wall_solid: expected at least 2 rings, 3 sectors and 1 layer");
  const RayTree trees[] = {RayTree(endo), RayTree(epi)};
  constexpr double step_mm = 0.5, lowest_mm = 12;
  HeartAxes lowered = axes;
  WallSolid solid;
  std::optional<Sheets> sheets;
  for (; !sheets && solid.lowered_mm <= lowest_mm; solid.lowered_mm += step_mm) {
    lowered.length_mm = axes.length_mm - solid.lowered_mm;
    if (lowered.length_mm > 0) sheets = meet(trees, lowered, size);
  }
  if (!sheets) return std::nullopt;
  solid.lowered_mm -= step_mm;
  solid.mesh = fill_between(sheets->side[0], sheets->side[1], size.layers);
  solid.volume_ml = volume_mm3(solid.mesh) / 1000;
  solid.surfaces_ml = (volume_mm3(epi) - volume_mm3(endo)) / 1000;
  solid.quality = tet_quality(solid.mesh);
  for (int layer = 0; layer <= size.layers; ++layer) {
    solid.ring.insert(solid.ring.end(), sheets->ring.begin(), sheets->ring.end());
    solid.layer.insert(solid.layer.end(), sheets->ring.size(), layer);
  }
  return solid;
}

}  // namespace dynasurf
