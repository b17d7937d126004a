#pragma once
// The study of the edge detectors: its hearts and its score. Tests ask it too.
#include <algorithm>
#include <vector>

#include "dynasurf/image/edges.hpp"

#include "../support/border_scores.hpp"

namespace dynasurf::experiments::edge_study {

constexpr double tolerance_px = 1;
constexpr int patients = 3;

/// The same hearts on voxels that show them 30 and 12 pixels wide.
inline std::vector<Scene> hearts(double spacing_mm, int pixels) {
  std::vector<Scene> scenes;
  for (int n = 0; n < patients; ++n) {
    synthetic::VirtualPatient o;
    o.gates = 1, o.edv_ml = 90 + 30 * n, o.wall_ml = 110 + 15 * n, o.fwhm_mm = 10 + n;
    o.lattice = {pixels, pixels, 24, spacing_mm, spacing_mm, 5.74};
    o.noise = {120, 8, 0, static_cast<std::uint64_t>(n + 1)};
    scenes.push_back(scene_of(synthetic::make_phantom(o)));
  }
  return scenes;
}

/// Mean width of the outer border where the hearts are widest, px.
inline double width_of(const std::vector<Scene>& scenes) {
  double sum = 0;
  for (const Scene& s : scenes) {
    double widest = 0;
    for (const auto& line : s.epi) {
      if (line.empty()) continue;
      const auto [low, high] = std::minmax_element(line.begin(), line.end(), [](auto a, auto b) { return a.x < b.x; });
      widest = std::max(widest, high->x - low->x);
    }
    sum += widest / static_cast<double>(scenes.size());
  }
  return sum;
}

struct Row {
  Score endo, epi;
  double edges = 0, components = 0;  // per slice through the cavity
};

/// Every pixel is held against the border that is nearer to it.
inline Row measure(const std::vector<Scene>& scenes, const image::EdgeOptions& options) {
  Row row;
  double slices = 0;
  for (const Scene& s : scenes) {
    const Mask edges = image::detect_edges(s.image, options).edges;
    for (int k = s.division_slice + 1; k < edges.grid.dims[2]; ++k) {
      const auto &endo = s.endo[static_cast<std::size_t>(k)], &epi = s.epi[static_cast<std::size_t>(k)];
      if (endo.empty() || epi.empty()) continue;
      std::vector<image::Pixel> inner, outer;
      const auto components = image::components_of_slice(edges, k);
      for (const image::Component& c : components)
        for (const image::Pixel& p : c.pixels)
          (distance_px(endo, p.i, p.j) < distance_px(epi, p.i, p.j) ? inner : outer).push_back(p);
      row.endo += score_slice(inner, endo, tolerance_px);
      row.epi += score_slice(outer, epi, tolerance_px);
      row.edges += static_cast<double>(inner.size() + outer.size());
      row.components += static_cast<double>(components.size());
      slices += 1;
    }
  }
  row.edges /= slices, row.components /= slices;
  return row;
}

}  // namespace dynasurf::experiments::edge_study
