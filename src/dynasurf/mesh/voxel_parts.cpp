#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::mesh {
namespace {

/// A convex piece of a triangle, in units of voxels: voxel n of an axis reaches from n to n + 1. Six cuts of a triangle
/// leave at most nine corners.
struct Piece {
  std::array<Vec3, 9> corners;
  int count = 0;
  void add(const Vec3& p) { corners[count++] = p; }
  const Vec3& operator[](int n) const { return corners[n]; }
  double low(int axis) const {
    return extreme(axis, [](double a, double b) { return std::min(a, b); });
  }
  double high(int axis) const {
    return extreme(axis, [](double a, double b) { return std::max(a, b); });
  }

 private:
  double extreme(int axis, double (*choose)(double, double)) const {
    double value = corners[0][axis];
    for (int n = 1; n < count; ++n) value = choose(value, (*this)[n][axis]);
    return value;
  }
};

/// What of a piece lies on one side of a plane: above `bound` with `side` 1, below it with -1.
Piece cut(const Piece& piece, int axis, double bound, double side) {
  Piece kept;
  for (int n = 0; n < piece.count; ++n) {
    const Vec3 &p = piece[n], &q = piece[(n + 1) % piece.count];
    const double before = side * (p[axis] - bound), after = side * (q[axis] - bound);
    if (before >= 0) kept.add(p);
    if ((before > 0 && after < 0) || (before < 0 && after > 0)) {
      Vec3 between = p + before / (before - after) * (q - p);
      between[axis] = bound;
      kept.add(between);
    }
  }
  return kept;
}

Piece slab(const Piece& piece, int axis, int voxel) { return cut(cut(piece, axis, voxel, 1), axis, voxel + 1, -1); }

/// The cells that a piece passes along an axis, within the grid.
std::pair<int, int> range(const Piece& piece, int axis, int extent) {
  const auto cell = [&](double x) { return floor_int(std::clamp(x, 0.0, extent - 0.5)); };
  return {cell(piece.low(axis)), cell(piece.high(axis))};
}

/// Area of the piece seen along k, positive where it faces upwards, and the volume under it above height `floor`.
struct Shadow {
  double area = 0, volume = 0;
};
Shadow shadow_of(const Piece& piece, double floor) {
  Shadow sum;
  for (int n = 2; n < piece.count; ++n) {
    const Vec3 &a = piece[0], &b = piece[n - 1], &c = piece[n];
    const double area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    sum.area += area;
    sum.volume += area * ((a[2] + b[2] + c[2]) / 3 - floor);
  }
  return sum;
}

/// Volume under all pieces so far. What lies under a piece is the voxel's own share, and every voxel below it whole.
struct Heap {
  const Grid& grid;
  std::vector<double> own;    // per voxel
  std::vector<double> above;  // per column and height 0 to dims[2]: the areas of pieces in the voxel over it

  explicit Heap(const Grid& g) : grid(g), own(g.size(), 0.0), above(g.size() + g.slice_size(), 0.0) {}

  void add_in_column(const Piece& piece, int i, int j) {
    const int nz = grid.dims[2];
    const double low = piece.low(2), high = piece.high(2);
    if (high <= 0) return;
    if (high >= nz) above[grid.index(i, j, nz)] += shadow_of(cut(piece, 2, nz, 1), 0).area;
    if (low >= nz) return;
    const auto [first, last] = range(piece, 2, nz);
    for (int k = first; k <= last; ++k) {
      const Shadow part = shadow_of(slab(piece, 2, k), k);
      own[grid.index(i, j, k)] += part.volume;
      above[grid.index(i, j, k)] += part.area;
    }
  }
};

void add_triangle(Heap& heap, const Piece& triangle) {
  const Index3& dims = heap.grid.dims;
  for (int axis = 0; axis < 2; ++axis)
    if (triangle.high(axis) <= 0 || triangle.low(axis) >= dims[axis]) return;
  const auto [first_i, last_i] = range(triangle, 0, dims[0]);
  for (int i = first_i; i <= last_i; ++i) {
    const Piece strip = slab(triangle, 0, i);
    if (strip.count < 3) continue;
    const auto [first_j, last_j] = range(strip, 1, dims[1]);
    for (int j = first_j; j <= last_j; ++j)
      if (const Piece piece = slab(strip, 1, j); piece.count >= 3) heap.add_in_column(piece, i, j);
  }
}

/// Sums of a column end a few roundings beside none and all.
float as_part(double sum) {
  constexpr double rounding = 1e-9;
  return sum < rounding ? 0.0F : sum > 1 - rounding ? 1.0F : sum;
}

}  // namespace

Image voxel_parts(const Grid& grid, const TriMesh& mesh) {
  if (const Topology t = topology(mesh); mesh.triangles.empty() || !t.closed() || !t.oriented())
    throw InputError("voxel_parts: the mesh is open or faces both ways; expected a closed, oriented surface");
  Heap heap(grid);
  for (const auto& t : mesh.triangles) {
    Piece triangle;
    for (const std::uint32_t v : t) triangle.add(mesh.vertices[v].cwiseQuotient(grid.spacing) + Vec3::Constant(0.5));
    add_triangle(heap, triangle);
  }
  Image parts(grid);
  for (int j = 0; j < grid.dims[1]; ++j)
    for (int i = 0; i < grid.dims[0]; ++i) {
      double whole = 0;
      for (int k = grid.dims[2] - 1; k >= 0; --k) {
        whole += heap.above[grid.index(i, j, k + 1)];
        parts(i, j, k) = as_part(heap.own[grid.index(i, j, k)] + whole);
      }
    }
  return parts;
}

}  // namespace dynasurf::mesh
