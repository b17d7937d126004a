#include "dynasurf/ventricle/measures/wall_solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/detail/ray_bvh.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::ventricle {
namespace {

/// Triangles of a cap: a fan around vertex 0 (the apex), then rings. Counter-clockwise seen from outside, where angles
/// run counter-clockwise seen from the apex.
std::vector<std::array<std::uint32_t, 3>> cap_triangles(int rings, int sectors) {
  const auto vertex = [&](int ring, int sector) {
    return ring == 0 ? 0u : 1 + (ring - 1) * sectors + sector % sectors;
  };
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(sectors * (2 * rings - 1));
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
  std::array<TriMesh, 2> side;
  std::vector<int> ring;   // of every vertex
  std::vector<Vec3> ways;  // of every vertex: the direction of its ray
};

/// Straight up or down the long axis onto the valve plane.
Vec3 on_base(const HeartAxes& axes, const Vec3& p) {
  return p - axes.above_base(p) / axes.axis.dot(axes.base_normal) * axes.axis;
}

/// Volume of the part of a surface below the valve plane, mm3: of one that is closed, or ends in the plane.
double volume_below_base(const TriMesh& mesh, const HeartAxes& axes) {
  const Vec3 base = axes.base();
  double six = 0;
  for (const auto& t : mesh.triangles) {
    // The part of the triangle below the plane, seen from a point of the plane: what closes it there adds nothing.
    std::array<Vec3, 4> part;
    std::size_t corners = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 &a = mesh.vertices[t[c]], &b = mesh.vertices[t[(c + 1) % 3]];
      const double height_a = axes.above_base(a), height_b = axes.above_base(b);
      if (height_a <= 0) part[corners++] = a - base;
      if ((height_a <= 0) != (height_b <= 0)) part[corners++] = a + height_a / (height_a - height_b) * (b - a) - base;
    }
    for (std::size_t c = 2; c < corners; ++c) six += part[0].dot(part[c - 1].cross(part[c]));
  }
  return six / 6;
}

/// Absent where a ray misses a surface, the wall turns inside out, or its rim is not that of a wall: surfaces that end
/// below the valve plane are met there by their lids' dents only.
std::optional<Sheets> meet(const mesh::RayBvh (&trees)[2], const HeartAxes& axes, const WallSolidSize& size) {
  // A ray in the valve plane runs along the lid: it looks a little below, and its point is moved back onto the plane.
  constexpr double far_mm = 300;
  constexpr double below_lid = 1e-4;  // of rho: some hundredths of a millimetre
  constexpr double least_rim = 0.5;   // radius of the outer rim over that at rho 3/4
  Sheets sheets;
  std::vector<double> middle(size.sectors, 0.0);
  for (int ring = 0; ring <= size.rings; ++ring)
    for (int sector = 0; sector < (ring == 0 ? 1 : size.sectors); ++sector) {
      const PolarPoint at{std::min(1.0 * ring / size.rings, 1 - below_lid), 360.0 * sector / size.sectors};
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
        const Vec3 p = ray.origin + radii[side] * ray.direction;
        sheets.side[side].vertices.push_back(ring == size.rings ? on_base(axes, p) : p);
      }
      if (radii[1] <= radii[0]) return std::nullopt;
      double& usual = middle[sector];
      if (4 * ring <= 3 * size.rings) usual = radii[1];
      if (ring == size.rings && radii[1] < least_rim * usual) return std::nullopt;
      sheets.ring.push_back(ring);
      sheets.ways.push_back(axes.ray(at, 0).direction);
    }
  sheets.side[0].triangles = sheets.side[1].triangles = cap_triangles(size.rings, size.sectors);
  return sheets;
}

/// A side with all its vertices moved along their rays; its rim stays in the base.
TriMesh moved(const Sheets& sheets, int side, double mm, const HeartAxes& axes) {
  TriMesh mesh = sheets.side[side];
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    mesh.vertices[v] += mm * sheets.ways[v];
    if (sheets.ring[v] == sheets.ring.back()) mesh.vertices[v] = on_base(axes, mesh.vertices[v]);
  }
  return mesh;
}

/// How far a side must move to hold `target_mm3`: by secants; the volume is nearly linear in so small a way.
double way_to_volume(const Sheets& sheets, int side, double target_mm3, const HeartAxes& axes) {
  const auto lacks = [&](double mm) { return target_mm3 - volume_below_base(moved(sheets, side, mm, axes), axes); };
  double last = 0, now = 0.05, lack_last = lacks(last);
  for (int n = 0; n < 8; ++n) {
    const double lack = lacks(now);
    if (std::abs(lack) < 1e-9 * target_mm3 || lack == lack_last) break;
    const double next = now - lack * (now - last) / (lack - lack_last);
    last = now, lack_last = lack, now = next;
  }
  return now;
}

}  // namespace

std::optional<WallSolid> wall_solid(const TriMesh& endo, const TriMesh& epi, const HeartAxes& axes,
                                    const WallSolidSize& size) {
  if (size.rings < 2 || size.sectors < 3 || size.layers < 1)
    throw OptionError("wall_solid: expected at least 2 rings, 3 sectors and 1 layer");
  const mesh::RayBvh trees[] = {mesh::RayBvh(endo), mesh::RayBvh(epi)};
  constexpr double step_mm = 0.5, lowest_mm = 12, most_moved_mm = 1;
  HeartAxes lowered = axes;
  WallSolid solid;
  std::optional<Sheets> sheets;
  for (; !sheets && solid.lowered_mm <= lowest_mm; solid.lowered_mm += step_mm) {
    lowered.length_mm = axes.length_mm - solid.lowered_mm;
    if (lowered.length_mm > 0) sheets = meet(trees, lowered, size);
  }
  if (!sheets) return std::nullopt;
  solid.lowered_mm -= step_mm;
  TriMesh sides[2];
  double held_mm3[2];
  for (const int side : {0, 1}) {
    held_mm3[side] = volume_below_base(side == 0 ? endo : epi, axes);
    const double way = way_to_volume(*sheets, side, held_mm3[side], lowered);
    if (!(std::abs(way) <= most_moved_mm)) return std::nullopt;
    solid.moved_mm = std::max(solid.moved_mm, std::abs(way));
    sides[side] = moved(*sheets, side, way, lowered);
  }
  solid.mesh = mesh::fill_between(sides[0], sides[1], size.layers);
  solid.volume_ml = mesh::volume_mm3(solid.mesh) / 1000;
  solid.surfaces_ml = (held_mm3[1] - held_mm3[0]) / 1000;
  solid.quality = mesh::tet_quality(solid.mesh);
  for (int layer = 0; layer <= size.layers; ++layer) {
    solid.ring.insert(solid.ring.end(), sheets->ring.begin(), sheets->ring.end());
    solid.layer.insert(solid.layer.end(), sheets->ring.size(), layer);
  }
  return solid;
}

}  // namespace dynasurf::ventricle
