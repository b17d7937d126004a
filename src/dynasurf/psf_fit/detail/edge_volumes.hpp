#pragma once
#include <span>
#include <vector>

#include "dynasurf/core/study.hpp"

namespace dynasurf::psf_fit {

/// What is usual between the volumes within the inner edges and those of a fit, and how far the fit follows what is
/// not.
struct EdgeBelief {
  double log_ratio = 0;  // of the edges' end-diastolic volume to the fit's
  double ef_points = 0;  // the edges' ejection fraction less the fit's
  double of_volume = 0;  // part of a ratio's deviation from the usual one, in logarithms; 0: not at all
  double of_ef = 0;      // part of the ejection fraction's
};

/// Behind a camera. A fitted point spread that is too wide by chance makes the wall thin and the cavity large; edges
/// take no part in that, so their ratio to the fit tells a part of its error. `fwhm_mm`: of the fitted point spread.
/// `is_filtered`: filtered backprojection.
EdgeBelief edge_belief(double fwhm_mm, Attenuation attenuation, bool is_filtered);

/// The fit's cavity volumes (mL, per gate), moved towards those within the edges. The course of the beat stays the
/// fit's; its depth follows the ejection fraction. Unchanged where there is no beat.
std::vector<double> towards_edges(std::span<const double> fitted_ml, std::span<const double> edge_ml,
                                  const EdgeBelief& belief);

}  // namespace dynasurf::psf_fit
