#pragma once
#include <vector>

#include "dynasurf/psf_fit/detail/fitted_mesh.hpp"

namespace dynasurf::psf_fit {

/// What a fit tells of the reconstruction that its study came through.
struct Reconstruction {
  double fwhm_mm = 0;  // of the fitted point spread; 0: sharp, no camera
  double misfit = 0;   // 0: none, as of images that no camera has seen; 1: what is usual behind one
  Attenuation attenuation = Attenuation::unknown;
  bool is_filtered = false;         // by a Butterworth filter
  bool is_thickness_given = false;  // by a person
  bool is_spect = true;             // what the outer wall does was learned of no other
};

/// Errors that fits make behind a camera, as learned from experiments/camera. `edge_ml`: volumes within the inner
/// edges, per gate.
Corrections camera_errors(const Reconstruction& reconstruction, const std::vector<double>& edge_ml);

/// Says in the beat's notes how far its walls were moved for them.
void tell_camera_errors(const BeatProblem& problem, const Solution& solution, const Corrections& known,
                        FittedBeat& beat);

}  // namespace dynasurf::psf_fit
