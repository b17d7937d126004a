#pragma once
// The study of ill hearts: its phantoms and what is measured of them. Tests ask it too.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/smooth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/labels/detail/mlc.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "../support/border_scores.hpp"

namespace dynasurf::experiments::pathologies {

struct Case {
  std::string name;
  synthetic::Pathology made;
};

inline std::vector<Case> cases() {
  const auto ill = [](synthetic::Disease disease, double amplitude = 0.8) {
    synthetic::Pathology p;
    p.disease = disease;
    p.amplitude = amplitude;
    return p;
  };
  synthetic::Pathology healthy = ill(synthetic::Disease::inferior);
  healthy.uptake = 1;
  return {{"healthy", healthy},
          {"inferior", ill(synthetic::Disease::inferior)},
          {"apical", ill(synthetic::Disease::apical)},
          {"lateral", ill(synthetic::Disease::lateral)},
          {"anteroapical", ill(synthetic::Disease::anteroapical)},
          {"digestive, 0.5", ill(synthetic::Disease::digestive, 0.5)},
          {"digestive, 1.0", ill(synthetic::Disease::digestive, 1.0)},
          {"right ventricle", ill(synthetic::Disease::right_ventricle, 0.4)},
          {"blood pool", ill(synthetic::Disease::muga)}};
}

/// Mean distance of the true surface's vertices to a surface, mm: what is missing of it counts too.
inline double mean_distance_mm(const TriMesh& truth, const TriMesh& mesh) {
  const mesh::ClosestPoint nearest(mesh);
  double sum = 0;
  for (const Vec3& p : truth.vertices) sum += std::sqrt(nearest(p).distance2);
  return sum / static_cast<double>(truth.vertices.size());
}

inline ventricle::Result reconstructed(const synthetic::Phantom& phantom) {
  return ventricle::reconstruct(phantom.study, ventricle::preset("psf_corrected"));
}

/// How well the border voxels of one wall lie on its true border and cover it (F1 of both, within 2 pixels).
inline double f1_of(const ventricle::Result& result, const TriMesh& truth, int bit) {
  const Grid& grid = result.study.grid();
  const TrueLines lines = true_lines(truth, grid);
  Score score;
  for (int k = 0; k < grid.dims[2]; ++k)
    score += score_slice(ventricle::pixels_of(result.gates.front().labels.borders, k, bit),
                         lines[static_cast<std::size_t>(k)], 2);
  return score.f1();
}

/// Vertices whose angles miss a plane's by more than the smoothing tolerates, below the lid and its rim.
inline int peaks_of(const std::optional<ventricle::Surface>& surface, const TriMesh& truth) {
  if (!surface) return -1;
  constexpr double rim_mm = 12;
  double top = -1e9;
  for (const Vec3& p : truth.vertices) top = std::max(top, p[2]);
  const std::vector<double> deficits = mesh::angle_deficits(surface->mesh);
  int peaks = 0;
  for (std::size_t v = 0; v < deficits.size(); ++v)
    peaks += surface->mesh.vertices[v][2] < top - rim_mm && std::abs(deficits[v]) > mesh::Smoothing{}.tolerance_rad;
  return peaks;
}

/// The surfaces as they came to rest, with and without the smoothing of the thesis (5.5), before anything else.
inline ventricle::Result at_rest(const synthetic::Phantom& phantom, bool is_smoothed) {
  ventricle::Options options = ventricle::preset("edges");
  options.settle.rounds = 0, options.tidy = {.shape = 0, .untangle_rounds = 0};
  if (!is_smoothed) options.evolution.smooth_every = 0, options.evolution.smooth_after.sweeps = 0;
  return ventricle::reconstruct(phantom.study, options);
}

}  // namespace dynasurf::experiments::pathologies
