#pragma once
#include <vector>

#include "dynasurf/psf_fit/detail/edge_volumes.hpp"
#include "dynasurf/psf_fit/detail/fitted_beat.hpp"
#include "dynasurf/psf_fit/detail/least_squares.hpp"

namespace dynasurf::psf_fit {

/// What a fit does not know of its own errors.
struct Corrections {
  double noise = 0;            // as in BeatProblem, of the errors alone
  double papillary_share = 0;  // of the muscle along every ray, or less (papillary_share.hpp), counts as cavity
  double model_factor = 1.3;   // of the normal matrix's deviations
  double wall_error = 0.045;   // part of the wall's volume that no counting makes sure
  // Added to the log of the inner wall's distance from the centre, times the part of the end-diastolic volume that is
  // put out. The muscle per solid angle stays.
  double near_by_contraction = 0;
  double beyond = 0;            // part of the muscle that lies outside the reported outer wall, of either sign
  std::vector<double> edge_ml;  // volume within the inner edges, per gate; none: nothing is learned from them
  EdgeBelief edges;
};

/// Where the errors that are known move the walls of a solution.
ReportedWalls reported_walls(const BeatProblem& problem, const Solution& solution, const Corrections& known);

/// Turns a solution into the reported surfaces, volumes and their error bars. Internal.
void describe_beat(const BeatProblem& problem, const Solution& solution, const Corrections& known, const Grid& grid,
                   FittedBeat& beat);

}  // namespace dynasurf::psf_fit
