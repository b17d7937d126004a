#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "dynasurf/core/detail/mean_point.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/detail/convex_hull.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

constexpr std::array<std::string_view, 8> kShapes{"ellipsoid",         "sphere", "cube", "hull", "marching_cubes",
                                                  "discretised_cubes", "radial", "file"};
constexpr std::array<std::string_view, 2> kDirections{"out_to_in", "in_to_out"};

/// The mesh moved and stretched so that its bounding box is [-1, 1]^3.
TriMesh boxed(TriMesh mesh) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vec3& p : mesh.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3 half = (high - low) / 2;
  if (mesh.triangles.empty() || !half.allFinite() || !(half.minCoeff() > 0))
    throw OptionError("placement.shape is file, and the given mesh has no extent; expected a surface around a volume");
  for (Vec3& p : mesh.vertices) p = (p - (low + high) / 2).cwiseQuotient(half);
  return mesh;
}

/// Sets the voxels of one slice across an axis that are border, or that no path within the slice leads out of.
void fill_slice(const Image& border, std::size_t axis, int slice, Image& solid) {
  const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
  const int width = border.grid.dims[a], height = border.grid.dims[b];
  const auto voxel = [&](int u, int v) {
    Index3 at{};
    at[axis] = slice, at[a] = u, at[b] = v;
    return border.grid.index(at[0], at[1], at[2]);
  };
  std::vector<std::uint8_t> outside(size_of({width, height, 1}), 0);
  std::vector<std::array<int, 2>> open;
  const auto reach = [&](int u, int v) {
    if (u < 0 || v < 0 || u >= width || v >= height) return;
    std::uint8_t& is_outside = outside[u + width * v];
    if (is_outside != 0 || border.values[voxel(u, v)] != 0) return;
    is_outside = 1;
    open.push_back({u, v});
  };
  for (int u = 0; u < width; ++u) reach(u, 0), reach(u, height - 1);
  for (int v = 0; v < height; ++v) reach(0, v), reach(width - 1, v);
  while (!open.empty()) {
    const auto [u, v] = open.back();
    open.pop_back();
    reach(u - 1, v), reach(u + 1, v), reach(u, v - 1), reach(u, v + 1);
  }
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      if (outside[u + width * v] == 0) solid.values[voxel(u, v)] = 1;
}

/// The corners of all non-zero voxels, each once, in the grid frame.
std::vector<Vec3> voxel_corners(const Image& border) {
  std::set<Index3> corners;
  for (int k = 0; k < border.grid.dims[2]; ++k)
    for (int j = 0; j < border.grid.dims[1]; ++j)
      for (int i = 0; i < border.grid.dims[0]; ++i)
        for (int n = 0; border(i, j, k) != 0 && n < 8; ++n)
          corners.insert({i + (n & 1), j + (n >> 1 & 1), k + (n >> 2)});
  std::vector<Vec3> places;
  places.reserve(corners.size());
  for (const Index3& c : corners)
    places.push_back((Vec3(c[0], c[1], c[2]) - Vec3::Constant(0.5)).cwiseProduct(border.grid.spacing));
  return places;
}

/// How far a ray from `centre` runs within the solid, in steps of a fifth of the smallest voxel side.
double way_within(const Image& solid, const Vec3& centre, const Vec3& direction) {
  const double step = solid.grid.spacing.minCoeff() / 5;
  double way = 0;
  for (;; way += step) {
    const Index3 v = voxel_of(solid.grid, centre + (way + step) * direction);
    if (!solid.grid.contains(v[0], v[1], v[2]) || solid(v[0], v[1], v[2]) == 0) return way;
  }
}

/// A sphere whose vertices lie on their rays where the solid that the border encloses ends, times the scale. Where the
/// middle of the box is not in the solid, its rays are short, so the box's ellipsoid is taken for them.
TriMesh radial_start(const Image& border, int level, const Placement& options) {
  const TriMesh unit = icosphere(level), box = place(unit, border, {.scale = 1});
  const double scale = options.direction == Direction::in_to_out ? options.inside_scale : options.scale;
  const Image solid = enclosed_solid(border);
  const Vec3 centre = mean_point(box.vertices);
  TriMesh start = box;
  for (Vec3& p : start.vertices) {
    const Vec3 ray = p - centre;
    const double within = way_within(solid, centre, ray.normalized());
    p = centre + scale * (within > 0 ? Vec3(within * ray.normalized()) : ray);
  }
  return start;
}

/// As many squares as give a cube about the vertices of the icosphere.
int cells_of_level(int level) { return std::max(1, round_int(1.25 * (1 << level))); }

}  // namespace

std::span<const std::string_view> names_of(StartShape) { return kShapes; }
std::span<const std::string_view> names_of(Direction) { return kDirections; }

TriMesh cube_surface(int cells) {
  if (cells < 1 || cells > 1000)
    throw OptionError("a cube of " + std::to_string(cells) + " cells per side; expected 1 to 1000");
  TriMesh mesh;
  std::map<Index3, std::uint32_t> vertex_at;
  const auto vertex = [&](const Index3& at) {
    const auto [where, is_new] = vertex_at.try_emplace(at, mesh.vertices.size());
    if (is_new) mesh.vertices.push_back(Vec3(at[0], at[1], at[2]) * 2 / cells - Vec3::Ones());
    return where->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true})
      for (int v = 0; v < cells; ++v)
        for (int u = 0; u < cells; ++u) {
          const auto corner = [&](int du, int dv) {
            Index3 at{};
            at[axis] = upper ? cells : 0;
            at[(axis + 1) % 3] = u + du;
            at[(axis + 2) % 3] = v + dv;
            return vertex(at);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (upper) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          } else {
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
          }
        }
  return mesh;
}

Image enclosed_solid(const Image& border) {
  Image solid(border.grid);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int slice = 0; slice < border.grid.dims[axis]; ++slice) fill_slice(border, axis, slice, solid);
  return solid;
}

TriMesh start_mesh(const Image& border, int level, const Placement& options, const TriMesh* given) {
  switch (options.shape) {
    case StartShape::cube:
      return place(cube_surface(cells_of_level(level)), border, options);
    case StartShape::marching_cubes:
      return marching_cubes(enclosed_solid(border), 0.5);
    case StartShape::discretised_cubes:
      return discretised_marching_cubes(enclosed_solid(border), 0.5);
    case StartShape::radial:
      return radial_start(border, level, options);
    case StartShape::hull:
      return place(boxed(even_hull(voxel_corners(border), std::size_t{20} << 2 * level)), border, options);
    case StartShape::file:
      if (given == nullptr) throw OptionError("placement.shape is file; expected a mesh to start from, none was given");
      return place(boxed(*given), border, options);
    case StartShape::ellipsoid:
    case StartShape::sphere:
      break;
  }
  return place(icosphere(level), border, options);
}

}  // namespace dynasurf::mesh
