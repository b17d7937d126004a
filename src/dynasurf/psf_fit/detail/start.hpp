#pragma once
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/psf_fit/detail/fit_start.hpp"
#include "dynasurf/psf_fit/detail/wall_model.hpp"

namespace dynasurf::psf_fit {

/// A start in the frame of a grid, and the heart's frame there.
struct PlacedStart {
  HeartFrame frame;
  std::vector<TriMesh> endo, epi;
  std::vector<heart::BasePlane> base;
  std::optional<Mask> looked_at;
  std::vector<WallPoint> points;
};
/// Both surfaces of every gate, the valve planes and the heart's frame of a start, for the voxels of a grid.
PlacedStart place_start(const FitStart& start, const Grid& grid);

/// Harmonics that give `values` at directions whose harmonics are the `rows`; fine ones only where the data ask for
/// them.
Eigen::VectorXd smooth_harmonics(const Eigen::MatrixXd& rows, const Eigen::VectorXd& values, int degree);

/// Harmonics of log q of a surface (grid frame), smooth where it was not seen. Vertices on its lid do not count.
Eigen::VectorXd harmonics_of_surface(const TriMesh& surface, const HeartFrame& frame, const heart::BasePlane& base,
                                     int degree);

/// Harmonics of the log of the wall's activity, healthy muscle is 0, as the brightest point along rays from the centre
/// shows it in the `mean` of the gates (in whose grid the start was placed). Blur and thickness change this brightness,
/// too: what is little below or above `healthy` counts for less, a defect for what it seems.
Eigen::VectorXd uptake_seen(const Image& mean, const PlacedStart& start, double healthy, int degree);

/// The numbers of every gate to begin with. `background` is in units of healthy muscle.
std::vector<Eigen::VectorXd> first_numbers(const PlacedStart& start, const GateLayout& layout, double background,
                                           double cavity);

}  // namespace dynasurf::psf_fit
