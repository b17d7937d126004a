#pragma once
#include <span>
#include <string_view>

#include "dynasurf/core/contour.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/dynamics/contour/detail/curvature.hpp"
#include "dynasurf/dynamics/options.hpp"
#include "dynasurf/field/vector_field.hpp"

namespace dynasurf::dynamics {

/// The discrete contour of Lobregt and Viergever (MOD-CONTOUR, thesis 3.4.1, eqs 3.43-3.49). The thesis publishes no
/// parameters; these are ours (O19).
struct DiscreteContour {
  double external = 1;
  double internal = 0.5;
  double damping = 0.5;
  double mass = 1;
  double step = 0.5;
  double edge_px = 2;
  int resample_every = 10;
  bool radial_only = true;
  CurvatureFilter filter = CurvatureFilter::fixed;
  double still_px = 1e-3;
  int still_checks = 5;
  int max_steps = 2000;
};
void describe(auto& visit, DiscreteContour& o) {
  visit("external", o.external, OptionInfo{"w_ex: weight of the field, whose largest vector should be 1", "", 0, 1e3});
  visit("internal", o.internal,
        OptionInfo{"w_in: weight of the local curvature force; 0 leaves the contour limp", "", 0, 1e3});
  visit("damping", o.damping, OptionInfo{"-w_damp: force against the velocity", "", 0, 1e3});
  visit("mass", o.mass, OptionInfo{"of each point", "", 1e-6, 1e6});
  visit("step", o.step, OptionInfo{"time step", "", 1e-6, 1e3});
  visit("edge_px", o.edge_px,
        OptionInfo{"l_des: edges below half of it are merged, above 1.5 of it split (thesis 3.48-3.49)", "px", 0.1,
                   1000});
  visit("resample_every", o.resample_every, OptionInfo{"steps between two resamplings; 0 never", "", 0, 1000000});
  visit("radial_only", o.radial_only,
        OptionInfo{"only the radial part of the field acts, so that points do not gather (thesis 3.32)"});
  visit("filter", o.filter, OptionInfo{"fixed {-1/2, 1, -1/2} or by local edge length"});
  visit("still_px", o.still_px, OptionInfo{"at rest below this velocity and acceleration", "px", 0, 1});
  visit("still_checks", o.still_checks, OptionInfo{"steps in a row", "", 1, 100000});
  visit("max_steps", o.max_steps, OptionInfo{"the run ends here in any case", "", 1, 100000000});
}

/// Where a contour came to rest.
struct ContourResult {
  Contour contour;
  StopReason reason = StopReason::max_steps;  // at_rest, max_steps, or diverged: shrunk to nothing or flown
                                              // apart; the contour is the last one that was in order
  int steps = 0;
};

/// Moves a contour under a field of its plane (see potential.hpp) until velocity and acceleration vanish. An empty
/// field (no values) stands for no external force. Throws InputError for fewer than 3 points or points that are not
/// finite, OptionError.
ContourResult evolve_contour(const Contour& start, const field::VectorField& field, const DiscreteContour& options);

/// One resampling (A.6): edges shorter than half of `edge_px` are replaced by their middle, then edges longer than
/// 1.5 `edge_px` are halved, again and again until none is left (at most 10 rounds). At least 3 points stay.
/// `carried`, one value per point, is averaged along; it may be empty.
void resample(Contour& contour, double edge_px, std::vector<Vec2>& carried);
void resample(Contour& contour, double edge_px);

}  // namespace dynasurf::dynamics
