#pragma once
#include <vector>

#include "dynasurf/psf_fit/detail/least_squares.hpp"

namespace dynasurf::psf_fit {

/// A hot spot beside the heart.
struct ExtracardiacSource {
  Vec3 centre{0, 0, 0};  // grid frame, mm
};

/// Spots that the time's mean of a residual asks for, strongest first, where `allowed` says so: `most` at most, each
/// brighter than `least` of healthy muscle.
std::vector<ExtracardiacSource> find_extracardiac_sources(const BeatProblem& problem, const Objective& objective,
                                                          const std::vector<bool>& allowed, double least, int most);

/// Such a spot of amplitude 1 as the camera sees it.
std::vector<float> blob_image(const BeatProblem& problem, const ExtracardiacSource& blob);

}  // namespace dynasurf::psf_fit
