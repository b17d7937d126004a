#pragma once
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/psf_fit/detail/psf_projector.hpp"
#include "dynasurf/psf_fit/detail/wall_model.hpp"

namespace dynasurf::psf_fit {

/// What the body's attenuation leaves in a reconstruction that does not correct it.
///
/// Each view weakens a place by the tissue before it, and determines the transverse frequencies along its detector.
/// The reconstruction therefore weights a transverse frequency by its direction and by the place: I = I0 + sum over K
/// in {1, C, S} of K[p_K I0], where C and S are the cosine and the sine of twice the direction of a transverse
/// frequency, and p_K is linear in place. In a chest the eleven coefficients of p_K are nearly the same from patient to
/// patient and for filtered backprojection and OSEM (experiments/camera), so that one amplitude tells most.
///
/// Returns [term][gate][pixel] what is added to images `model` of each gate, on the fit's pixels and over `unit`: by
/// the usual coefficients, then by each of the eleven alone. Where the weight of a pixel is 0, and beyond the pixels,
/// the study itself takes the place of the model.
std::vector<std::vector<std::vector<float>>> attenuation_images(const Study& study, const Pixels& pixels,
                                                                const HeartFrame& frame, double unit,
                                                                const std::vector<std::vector<float>>& model,
                                                                const std::vector<float>& weight);

/// From the grid's axes to the patient's: left, back, head. A heart whose long axis runs along the body lies in a study
/// that does not tell its orientation, and is taken to lie as most do: 45 degrees to the left and 30 downwards.
Mat3 to_patient(const Grid& grid, const HeartFrame& frame);

}  // namespace dynasurf::psf_fit
