#pragma once
#include <algorithm>

#include "dynasurf/psf_fit/detail/blur_options.hpp"
#include "dynasurf/psf_fit/detail/fit_start.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

// A study that is fitted in well under a second, and what a fit of it begins with.

namespace dynasurf::psf_fit::test {

/// A small heart of four gates on coarse voxels: seen in well under a second.
inline synthetic::Phantom small_study(double fwhm_mm, double right_ventricle = 0, double papillary_mm = 0,
                                      int gates = 4) {
  synthetic::VirtualPatient o;
  o.edv_ml = 90, o.ef_percent = 50, o.wall_ml = 100;
  o.gates = gates;
  o.fwhm_mm = fwhm_mm;
  o.noise.peak_counts = 0;
  o.right_ventricle = right_ventricle;
  o.irregular.papillary_mm = papillary_mm;
  o.pose.tilt_deg = 12;
  o.lattice = {28, 28, 24, 4.8, 4.8, 4.8};
  return synthetic::make_phantom(o);
}

/// Surfaces as edges of a blurred image give them: the cavity too small, the whole too large.
inline FitStart biased_start(const synthetic::Phantom& phantom) {
  FitStart start;
  const auto scaled = [](TriMesh mesh, double factor) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : mesh.vertices) middle += p / static_cast<double>(mesh.vertices.size());
    for (Vec3& p : mesh.vertices) p = middle + factor * (p - middle);
    return mesh;
  };
  for (const synthetic::TrueGate& gate : phantom.truth) {
    start.endo.push_back(scaled(gate.endo, 0.9));
    start.epi.push_back(scaled(gate.epi, 1.05));
    // From the apex, the first vertex, to the lid's middle, the last.
    const TriMesh& epi = gate.epi;
    heart::BasePlane base;
    base.point = epi.vertices.back();
    base.normal = (epi.vertices.back() - epi.vertices.front()).normalized();
    start.base.emplace_back(base);
  }
  start.axis = start.base.front()->normal;
  start.lateral = phantom.study.grid().direction.col(0);
  return start;
}

inline BlurFit known_blur(double fwhm_mm) {
  BlurFit options;
  options.run = true;
  options.fwhm_mm = fwhm_mm;
  options.fwhm_uncertainty = 0;
  options.papillary_share = 0;  // these hearts have none
  return options;
}

/// The same stripes in every gate, finer than any wall: misfit of a reconstruction.
inline void add_stripes(Study& study) {
  const std::vector<float>& first = study.gates.front().values;
  const float stripe = 0.03F * *std::max_element(first.begin(), first.end());
  for (Image& gate : study.gates)
    for (std::size_t n = 0; n < gate.values.size(); ++n) gate.values[n] += n % 2 == 0 ? stripe : -stripe;
}

}  // namespace dynasurf::psf_fit::test
