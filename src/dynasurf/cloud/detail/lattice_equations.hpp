#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "dynasurf/cloud/detail/by_cell.hpp"
#include "dynasurf/cloud/detail/lattice.hpp"
#include "dynasurf/cloud/detail/orient.hpp"
#include "dynasurf/core/progress.hpp"

namespace dynasurf::cloud {

/// The nodes that are solved for, as runs along the rows, slab after slab. The others keep the value of their start.
struct Runs {
  std::vector<std::pair<std::size_t, std::size_t>> nodes;  // first, and behind the last
  std::vector<std::size_t> first_of_slab;                  // of its runs, and the end
};

/// The equations of the indicator function on one lattice: the seven-point Laplacian plus, for each point, a pull of
/// its value to 0. The lattice must outlive them.
class LatticeEquations {
 public:
  /// The points lie within the lattice. `closeness`: how strongly values at the points are pulled to 0.
  LatticeEquations(const Lattice& lattice, const OrientedPoints& points, double closeness);

  /// At the nodes of `runs`, from the start in `x`, by conjugate gradients with the diagonal as preconditioner. May be
  /// called once.
  void solve(Runs runs, std::vector<float>& x, int iterations, const Progress& progress);

 private:
  using Values = std::vector<float>;
  /// Of the eight nodes of a cell: how each pulls at each.
  using Form = std::array<float, 64>;
  struct Cell {
    std::size_t at;
    Form form;
  };

  void add_slopes(const OrientedPoints& points, std::uint32_t i);
  void gather_cells(const OrientedPoints& points, double closeness);
  void find_slabs_of_cells();
  double apply(const Values& x, Values& y) const;
  double add_cell(const Cell& c, const Values& x, Values& y) const;

  const Lattice& lattice_;
  Runs runs_;
  std::array<std::size_t, 8> steps_;
  Values right_, scale_;  // the right side; the diagonal, one over it where it is solved for
  std::vector<Cell> cells_;
  std::vector<InCell> order_;               // the points by cells, until they are added up
  std::vector<std::size_t> first_of_cell_;  // in that order, and the end
  std::vector<std::size_t> slab_of_cells_;  // where the cells of each slab begin, and the end
};

}  // namespace dynasurf::cloud
