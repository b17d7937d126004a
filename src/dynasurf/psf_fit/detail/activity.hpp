#pragma once
#include <span>
#include <vector>

#include <Eigen/Core>

#include "dynasurf/psf_fit/detail/matrix_loops.hpp"
#include "dynasurf/psf_fit/detail/psf_projector.hpp"
#include "dynasurf/psf_fit/detail/wall_model.hpp"

namespace dynasurf::psf_fit {

/// The cells of a lattice that a heart may fill, and where they lie in its frame.
struct HeartCells {
  CellLattice lattice;
  HeartFrame frame;
  std::vector<std::size_t> cell;    // place in the lattice
  detail::AlignedMatrix harmonics;  // a line per harmonic, a value per cell
  std::vector<float> q, edge_q;     // distance from the centre, and the width of an edge there, both over the scale
  std::vector<float> x, y, z;       // mm in the heart's frame
};
/// Keeps the cells within `margin_mm` of a surface, given by the harmonics of log q up to a degree, and less than
/// `highest_mm` over the centre. `degree`: of the harmonics that are laid down for each cell.
HeartCells select_cells(const CellLattice& lattice, const HeartFrame& frame, int degree, double highest_mm,
                        const Eigen::VectorXd& surface, int surface_degree, double margin_mm);

/// One gate's activity in those cells, above the background, and what its derivatives need. Edges are Gaussian steps of
/// the lattice's width; along every ray they keep the volume of a sharp edge.
struct Activity {
  std::vector<float> endo, epi, below;          // share of the cell inside each wall, and below the base plane
  std::vector<float> by_endo, by_epi;           // derivatives of the first two by log q_endo and by q_epi
  std::vector<float> by_plane;                  // of the third by the plane's height
  std::vector<float> epi_by_endo, epi_by_wall;  // derivatives of q_epi by log q_endo and by log of the muscle
  std::vector<float> uptake;
  std::vector<float> cells;  // activity above the background, on the whole lattice
  double cavity_mm3 = 0, wall_mm3 = 0;
};

/// The walls and the uptake seen from each cell: a line per gate, or one that is the same in all gates. Log of q_endo,
/// of the muscle, and of the uptake.
struct CellFields {
  detail::AlignedMatrix endo, wall, uptake;
};
/// Those of some gates of a beat.
CellFields fields_of(const HeartCells& cells, const GateLayout& layout, const std::vector<Eigen::VectorXd>& gates);

/// `g`: which of the fields' gates `gate` is.
Activity rasterise(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                   const CellFields& fields, std::size_t g);
Activity rasterise(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate);

/// Derivatives of a quantity by the fields at each cell, a line per gate, and by the gates' other numbers.
struct CellGradients {
  detail::AlignedMatrix endo, wall, uptake;
  std::vector<Eigen::VectorXd> others;  // in the places of the layout, 0 where the harmonics are
};
/// All zero, to be added to.
CellGradients no_gradients(const HeartCells& cells, const GateLayout& layout, std::size_t gates);
/// Puts those of gate `g` there, of a quantity that has the derivatives `by_cell` by the activity of each cell of the
/// lattice (may be empty), and `by_cavity`, `by_wall` by the two volumes in mm3.
void backpropagate_to_cells(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                            const Activity& activity, std::span<const float> by_cell, double by_cavity, double by_wall,
                            CellGradients& to, std::size_t g);
/// The same by the numbers of each gate.
std::vector<Eigen::VectorXd> gather(const HeartCells& cells, const GateLayout& layout, const CellGradients& gradients);
Eigen::VectorXd backpropagate(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                              const Activity& activity, std::span<const float> by_cell, double by_cavity,
                              double by_wall);

}  // namespace dynasurf::psf_fit
