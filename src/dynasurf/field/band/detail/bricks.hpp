#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/field/band.hpp"

namespace dynasurf::field::band {

constexpr int side = 8;  // cells of a brick along an axis
constexpr std::size_t brick_cells = 512;

// Every function that takes or returns a vector is inlined, so that no calling convention is touched.
#pragma GCC diagnostic ignored "-Wpsabi"

/// A row of a brick. The compiler splits it where the machine's vectors are shorter.
typedef float Row __attribute__((vector_size(32)));

DYNASURF_INLINE Row load(const float* p) {
  Row row;
  __builtin_memcpy(&row, p, sizeof row);
  return row;
}
DYNASURF_INLINE void store(float* p, Row row) { __builtin_memcpy(p, &row, sizeof row); }

using Cells = std::array<float, brick_cells>;
using Cells3 = std::array<Cells, 3>;

/// The six faces of a brick: -x, +x, -y, +y, -z, +z.
constexpr int faces = 6;

/// One axis of a grid of cells, padded to whole bricks. All cells have the same width but the last one, which is
/// narrower where a finer grid had an odd number of cells: the grids of all levels end at the same wall. Otherwise a
/// residual that sums to nothing over the fine cells would not over the coarse ones, and the field as a whole would
/// drift.
struct Axis {
  int count = 1;
  double nominal = 1;              // width of a regular cell; mu is folded in, so that diffusion is 1/width^2
  std::vector<double> width;       // one per cell
  std::vector<float> left, right;  // diffusion towards the neighbours; 0 at the walls and beyond
  bool halved = false;             // the next coarser level joins pairs of cells
  std::vector<float> share;        // of a cell in the width of the coarser cell that holds it; 0 beyond the wall
};

/// A grid of cells, of which only those of some bricks exist: those near data and those that finer bricks interpolate
/// from. Full where the grid is small.
struct Level {
  Index3 dims{1, 1, 1};    // cells
  Index3 bricks{1, 1, 1};  // bricks along each axis
  std::array<Axis, 3> axis;

  std::vector<std::int32_t> brick_at;                     // of all bricks of the box: number, or -1
  std::vector<Index3> place;                              // of each brick that exists, in bricks
  std::vector<Cells3> u, rhs, before;                     // field, right-hand side, field before the last correction
  std::vector<Cells> b, d;                                // data term; 1 / diagonal, 0 outside the grid
  std::vector<std::uint8_t> plain;                        // finest level: the brick has no data and touches no wall
  std::vector<std::uint8_t> covered;                      // eighths of a brick that finer bricks refine, as bits
  std::vector<std::array<std::int32_t, faces>> ghost_at;  // number of the 8x8 ghosts beyond a face, or -1
  std::vector<std::array<std::array<float, 64>, 3>> ghosts;

  int number(const Index3& brick) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (brick[a] < 0 || brick[a] >= bricks[a]) return -1;
    return brick_at[index_in(bricks, brick)];
  }
};

/// The cell (i, j, k) of a brick in the level's grid.
inline Index3 cell_of(const Index3& brick, int i, int j, int k) {
  return {side * brick[0] + i, side * brick[1] + j, side * brick[2] + k};
}
inline bool is_inside(const Index3& cell, const Index3& dims) {
  return cell[0] < dims[0] && cell[1] < dims[1] && cell[2] < dims[2];
}

/// Place of a cell in its brick.
inline std::size_t cell_at(int i, int j, int k) { return i + side * (j + side * k); }

/// What a border map is on a brick: b and b times the gradient.
struct BrickData {
  Index3 place;
  Cells b;
  Cells3 pull;
};

/// All levels. The finest holds the bricks with a cell within `reach` cells of data, each coarser one those that the
/// finer one's cells and the layer around them are interpolated from.
std::vector<Level> build(const Grid& grid, const std::array<double, 3>& rates, const std::vector<BrickData>& data,
                         int reach);

/// Full multigrid and cycles on the composite of all levels until the estimated error is below the tolerance.
struct Outcome {
  int cycles = 0;
  double error = 0;
};
Outcome solve(std::vector<Level>& levels, double tolerance, int most_cycles, const Progress& progress);

}  // namespace dynasurf::field::band
