#pragma once
#include <optional>
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/ventricle/base_plane.hpp"
#include "dynasurf/ventricle/fit/detail/least_squares.hpp"
#include "dynasurf/ventricle/lv_shell.hpp"

namespace dynasurf::ventricle {

/// What a fit begins with: both surfaces of every gate, where the ventricle ends, and its long axis. World frame.
/// With a `cup`, the middle of the wall as it was located, walls of even thickness around it take the place of the
/// surfaces: an edge that a defect or a neighbour led astray leads no fit astray.
struct FitStart {
  std::vector<TriMesh> endo, epi;              // one per gate
  std::vector<std::optional<BasePlane>> base;  // one per gate; absent: where the surfaces end
  Vec3 axis{0, 0, 1};                          // from apex to base, any length but 0
  Vec3 lateral{1, 0, 0};                       // direction of the heart's x, not along the axis
  std::optional<LvShell> cup;
};

/// The same in the frame of a grid, and the heart's frame there.
struct PlacedStart {
  HeartFrame frame;
  std::vector<TriMesh> endo, epi;
  std::vector<BasePlane> base;
};
PlacedStart place_start(const FitStart& start, const Grid& grid);

/// Harmonics that give `values` at directions whose harmonics are the `rows`; fine ones only where the data ask for
/// them.
Eigen::VectorXd smooth_harmonics(const Eigen::MatrixXd& rows, const Eigen::VectorXd& values, int degree);

/// Harmonics of log q of a surface (grid frame), smooth where it was not seen. Vertices on its lid do not count.
Eigen::VectorXd harmonics_of_surface(const TriMesh& surface, const HeartFrame& frame, const BasePlane& base,
                                     int degree);

/// Harmonics of the log of the wall's activity, healthy muscle is 0, as the brightest point along rays from the centre
/// shows it in the `mean` of the gates (in whose grid the start was placed). Blur and thickness change this brightness,
/// too: what is little below or above `healthy` counts for less, a defect for what it seems.
Eigen::VectorXd uptake_seen(const Image& mean, const PlacedStart& start, double healthy, int degree);

/// The numbers of every gate to begin with. `background` is in units of healthy muscle.
std::vector<Eigen::VectorXd> first_numbers(const PlacedStart& start, const GateLayout& layout, double background,
                                           double cavity);

}  // namespace dynasurf::ventricle
