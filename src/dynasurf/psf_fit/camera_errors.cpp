#include "dynasurf/psf_fit/detail/camera_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::psf_fit {
namespace {

// By how much of its distance from the centre the inner wall reads too near behind a camera, times the part of the
// end-diastolic volume that is put out: what is left after the model of attenuation, and of resolution recovery.
// Learned from seeds 1 to 30.
constexpr double near_by_contraction_uncorrected = 0.043, near_by_contraction_corrected = -0.02;

// Part of the edges' volume that is believed where the thickness was given: half of what it is without, chosen on seeds
// 10 to 39.
constexpr double volume_of_known_thickness = 0.25;

/// Part of the muscle that a fit puts outside the outer wall. Learned from seeds 1 to 40 and 101 to 150: a Gaussian in
/// place of a Butterworth filter leaves walls too thick, recovered resolution too thin; from 15.1 to 16.1 mm the width
/// tells whether it was recovered.
double beyond_outer_wall(const Reconstruction& seen) {
  constexpr double filtered = 0.1, recovered = -0.085, narrow_mm = 15.1, wide_mm = 16.1;
  if (!seen.is_spect) return 0;
  if (seen.is_filtered) return seen.is_thickness_given ? 0 : filtered;
  if (seen.attenuation != Attenuation::corrected) return 0;
  return recovered * std::clamp((wide_mm - seen.fwhm_mm) / (wide_mm - narrow_mm), 0.0, 1.0);
}

/// What the normal matrix's deviations are multiplied by, so that intervals hold the truth in 90 % of the studies:
/// chosen on seeds 1 to 40 and 101 to 205.
double factor_behind_camera(Attenuation attenuation, bool is_filtered) {
  if (attenuation == Attenuation::corrected) return 1.06;
  return is_filtered ? 0.94 : 0.85;
}

void tell_contraction(double near_by_contraction, FittedBeat& beat) {
  if (near_by_contraction == 0 || !beat.ef_percent) return;
  const bool is_near = near_by_contraction > 0;
  char text[200];
  std::snprintf(text, sizeof text,
                "attenuation was %s: at end-systole the inner wall was moved %s by %.1f %% of its distance from the "
                "centre, as learned behind a simulated camera",
                is_near ? "not corrected" : "corrected", is_near ? "outwards" : "inwards",
                std::abs(near_by_contraction) * beat.ef_percent->value);
  beat.notes.push_back({Severity::info, "fit.contraction", text});
}

void tell_outer_wall(double beyond, FittedBeat& beat) {
  if (beyond == 0) return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "behind this reconstruction walls read too %s: the outer wall was moved %s by %.0f %% of the muscle, as "
      "learned behind a simulated camera",
      beyond > 0 ? "thick" : "thin", beyond > 0 ? "inwards" : "outwards", 100 * std::abs(beyond));
  beat.notes.push_back({Severity::info, "fit.outer_wall", text});
}

void tell_edges(const BeatProblem& problem, const Solution& solution, FittedBeat& beat) {
  if (problem.reported.edge_share.empty() || beat.gates.size() < 2) return;
  const std::size_t ed = beat.ed_gate;
  const double moved_ml = problem.reported.edge_share[ed] * solution.objective.activity[ed].wall_mm3 / 1000;
  char text[320];
  std::snprintf(
      text, sizeof text,
      problem.thickness.is_given
          ? "behind a camera a thick wall and a wide point spread look alike: the end-diastolic volume was moved by "
            "%+.1f mL, as the volume within the edges asks, learned behind a simulated camera"
          : "behind a camera a thick wall and a wide point spread look alike: the end-diastolic volume was moved by "
            "%+.1f mL, as the volume within the edges asks, learned behind a simulated camera; a measured thickness "
            "of the wall (fit.thickness_mm) tells more",
      moved_ml);
  beat.notes.push_back({Severity::info, "fit.edge_volumes", text});
}

}  // namespace

Corrections camera_errors(const Reconstruction& seen, const std::vector<double>& edge_ml) {
  Corrections known;
  const bool is_seen = seen.fwhm_mm > 0;
  const double usual_factor = known.model_factor;
  known.model_factor += seen.misfit * (factor_behind_camera(seen.attenuation, seen.is_filtered) - usual_factor);
  // A camera hardly tells the wall's thickness, and reconstructions move it: chosen on the same seeds and 206 to 235.
  known.wall_error = own::hypot(known.wall_error, 0.09 * seen.misfit);
  if (is_seen && seen.attenuation == Attenuation::uncorrected)
    known.near_by_contraction = near_by_contraction_uncorrected;
  if (is_seen && seen.attenuation == Attenuation::corrected) known.near_by_contraction = near_by_contraction_corrected;
  if (is_seen && seen.misfit > 0) {
    known.edges = edge_belief(seen.fwhm_mm, seen.attenuation, seen.is_filtered);
    if (seen.is_thickness_given) known.edges.of_volume = std::min(known.edges.of_volume, volume_of_known_thickness);
    known.edges.of_volume *= seen.misfit, known.edges.of_ef *= seen.misfit;
    known.edge_ml = edge_ml;
    known.beyond = seen.misfit * beyond_outer_wall(seen);
  }
  return known;
}

void tell_camera_errors(const BeatProblem& problem, const Solution& solution, const Corrections& known,
                        FittedBeat& beat) {
  tell_contraction(known.near_by_contraction, beat);
  tell_outer_wall(known.beyond, beat);
  tell_edges(problem, solution, beat);
}

}  // namespace dynasurf::psf_fit
