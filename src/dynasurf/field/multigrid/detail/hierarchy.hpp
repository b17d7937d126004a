#pragma once
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "dynasurf/field/multigrid/detail/level.hpp"

namespace dynasurf::field::multigrid {

/// What can be done to all cells of a level, in the order of need: each reads what the one before wrote up to one slice
/// further.
enum class Stage {
  red_from_rhs,
  red,
  red_measured,
  black,
  red_near_data,
  black_near_data,
  black_beside_data,  // all that a red sweep near data changes
  start_black,
  continue_black,
  continue_red,
  take_back_black,
  correct_black,
  restrict_residual,
  copy_out
};

/// The solver works on levels [0, count): 0 holds the voxels, the last one a single cell.
struct Hierarchy {
  std::vector<Level>& levels;
  std::array<float*, 3> field;
  Rows started = {};  // voxels that have values before the others
  float stretch_of_start = 1;

  /// All stages in one pass over a level.
  void run(std::size_t l, std::span<const Stage> stages) { run(l, stages, all_of(levels[l])); }
  /// Solves the residual equation on level l+1 roughly; `top` is the level whose cycle this belongs to.
  void correct(std::size_t l, std::size_t top);
  /// Full multigrid on all levels but the voxels: each starts from the solution of the next coarser one.
  void solve_coarse();
  /// First values of the voxels; true where a cycle was spent on them.
  bool start_voxels();

 private:
  void run(std::size_t l, std::span<const Stage> stages, const Rows& last);
  void cycles(std::size_t l, std::size_t top, int count);
  static Rows all_of(const Level& l) { return {0, l.nz(), 0, l.ny()}; }
  void apply(std::size_t l, Stage stage, const Rows& rows);
  void in_and_around_started(const Rows& rows, const std::function<void(const Rows&)>& in,
                             const std::function<void(const Rows&)>& around) const;
  void run_in_strips(std::size_t l, std::span<const Stage> stages, const Rows& last);
};

/// True where the next coarser level joins pairs of cells along every axis that has more than one.
bool joins_all_axes(const Level& level);

/// From a field that was improved to the next residual.
inline constexpr Stage resume[] = {Stage::red, Stage::black, Stage::restrict_residual};

}  // namespace dynasurf::field::multigrid
