#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "dynasurf/core/detail/lanes.hpp"
#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/grid.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::field::multigrid {

using namespace simd;

constexpr int block_size = 80;  // floats of a block of data: d, b and the gradient of 16 cells

/// One axis of a grid of cells. All cells have the same width but the last one, which is narrower where a finer grid
/// had an odd number of cells: the grids of all levels end at the same wall.
struct Axis {
  int count = 0;
  double nominal = 1;              // width of a regular cell; mu is folded in, so that diffusion is 1/width^2
  std::vector<double> width;       // one per cell
  std::vector<float> left, right;  // diffusion towards the neighbours; 0 at the walls
  bool halved = false;             // the next coarser level joins pairs of cells
  std::vector<float> share;        // of a cell in the width of the coarser cell that holds it
};

/// The rows [j0, j1) of the slices [k0, k1).
struct Rows {
  int k0 = 0, k1 = 0, j0 = 0, j1 = 0;
};

/// A grid of the hierarchy with its unknowns and its operator (b - lap).
///
/// Colours: a cell is red when i+j+k is even. A row keeps its cells of even i first, then those of odd i, so that the
/// cells of one colour are contiguous and the two neighbours along i of lane m are lanes m-1 and m (or m and m+1) of
/// the other half. A row of `u` and `rhs` holds x even, x odd, y even, y odd, z even, z odd; of `b` and `d` even, odd.
/// Unused lanes of `d` are 0, so that what they hold stays finite and is never asked for.
struct Level {
  std::array<Axis, 3> axis;
  int slot = 0;                      // floats of half a row, a multiple of `lanes`
  std::size_t stride = 0;            // floats from row to row of `u` and `rhs`
  detail::FloatBuffer u, rhs, b, d;  // the finest level has only `u`
  detail::FloatBuffer lane_values;   // left, right, diagonal, share along i: two halves each

  // The finest level: most blocks of 16 cells have b = 0; the others keep d, b and the gradient in 80 floats.
  bool finest = false;
  float stretch = 1;  // factor of the corrections that come from the coarser level
  detail::FloatBuffer blocks;
  std::vector<std::int32_t> block_of;         // row, half, block: number of its 80 floats, or -1
  Rows data;                                  // a box around all blocks
  std::vector<std::array<int, 2>> data_rows;  // of each slice those with blocks: the first and one past the last
  detail::FloatBuffer empty_d;                // d of rows without data, for the first, inner and last row and slice
  std::vector<double> change, size;  // finest: sums of squares over each row's red cells in the last measured sweep

  int nx() const { return axis[0].count; }
  int ny() const { return axis[1].count; }
  int nz() const { return axis[2].count; }
  std::size_t cells() const { return size_of({nx(), ny(), nz()}); }
  std::size_t row_number(int j, int k) const { return index_in({1, ny(), nz()}, {0, j, k}); }
  std::size_t row(int j, int k) const { return lanes + stride * row_number(j, k); }
  std::size_t scalar_row(int j, int k) const { return 2 * slot * row_number(j, k); }

  const float* lane_left(int half) const { return lane_values.data() + half * slot; }
  const float* lane_right(int half) const { return lane_values.data() + (2 + half) * slot; }
  const float* lane_diagonal(int half) const { return lane_values.data() + (4 + half) * slot; }
  const float* lane_share(int half) const { return lane_values.data() + (6 + half) * slot; }
  float yz_diagonal(int j, int k) const {
    const std::size_t y = j, z = k;
    return (axis[1].left[y] + axis[1].right[y]) + (axis[2].left[z] + axis[2].right[z]);
  }
  const std::int32_t* blocks_of(int j, int k, int half) const {
    return block_of.data() + (row_number(j, k) * 2 + half) * (slot / lanes);
  }
  const float* empty_d_of(int j, int k, int half) const {
    const int y = j == 0 ? 0 : j + 1 == ny() ? 2 : 1, z = k == 0 ? 0 : k + 1 == nz() ? 2 : 1;
    return empty_d.data() + ((z * 3 + y) * 2 + half) * slot;
  }
};

/// b of a voxel whose gradient has the square `s`: s itself for GVF, exp(|grad f|/K) - 1 for GGVF.
struct DataTerm {
  double inverse_k = 0;  // 0: GVF
};

/// The data term b over the voxels.
struct DataStrength {
  double largest = 0, mean = 0;
};

/// Builds all levels from the map; `rates` is the diffusion along each axis per mm of field. Memory of an earlier map
/// is reused where it fits. Where the largest b is 0 the levels are not complete.
DataStrength build(std::vector<Level>& levels, const Image& map, const Vec3& rates, const DataTerm& term);

// ---- What is done to the rows [j0, j1) of the slices [k0, k1). Cells of one colour depend on the other colour alone.

enum class Start {
  warm,       // improve u
  measured,   // the same, and note how much it changed (finest level)
  near_data,  // the same where there are data and beside them (finest level)
  from_rhs,   // all of u counts as 0
};
void sweep(Level& level, int k0, int k1, int j0, int j1, int colour, Start start);

/// Right-hand side of the coarser level on its rows [j0, j1) of its slices [k0, k1): the residual that red cells have
/// after black ones were swept.
void restrict_residual(Level& fine, Level& coarse, int k0, int k1, int j0, int j1);

/// Adds (b - lap) u to `stretch` times the right-hand side: from residuals to the equation of which u is the first
/// guess.
void add_operator(Level& coarse, float stretch, int k0, int k1, int j0, int j1);

/// Adds the coarser level's correction, `stretch` times, to the black cells; red ones need none, their next sweep
/// overwrites them.
void correct_black(Level& fine, const Level& coarse, float stretch, int k0, int k1, int j0, int j1);

/// First values of black cells from the coarser level's solution.
void start_black(Level& fine, const Level& coarse, int k0, int k1, int j0, int j1);

/// Writes u of the rows [j0, j1) of slice k in the natural order of voxels.
void copy_out(const Level& level, int k, int j0, int j1, std::array<float*, 3> out);

}  // namespace dynasurf::field::multigrid
