#pragma once
// Edge pixels against the true borders of a phantom, for the experiments on edges and labels.
#include <algorithm>
#include <cmath>
#include <vector>

#include "dynasurf/core/grid.hpp"
#include "dynasurf/image/detail/components.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::experiments {

/// Points on a border in one slice, px, closer together than a pixel.
struct TruePoint {
  double x, y;
};
using TrueLines = std::vector<std::vector<TruePoint>>;  // per slice

/// Where a closed surface (world frame) passes through the middle of every slice.
inline TrueLines true_lines(const TriMesh& surface, const Grid& grid) {
  constexpr double step_px = 0.25;
  TrueLines lines(static_cast<std::size_t>(grid.dims[2]));
  if (surface.vertices.empty()) return lines;
  for (int k = 0; k < grid.dims[2]; ++k) {
    const Vec3 middle = to_world(grid, centre_of(grid, {0, 0, k}));
    for (const auto& polygon : mesh::cross_section(surface, middle, grid.direction.col(2)))
      for (std::size_t n = 1; n < polygon.size(); ++n) {
        const Vec3 a = to_grid(grid, polygon[n - 1]).cwiseQuotient(grid.spacing),
                   b = to_grid(grid, polygon[n]).cwiseQuotient(grid.spacing);
        const int pieces = 1 + static_cast<int>((b - a).norm() / step_px);
        for (int p = 0; p < pieces; ++p) {
          const Vec3 at = a + (b - a) * (static_cast<double>(p) / pieces);
          lines[static_cast<std::size_t>(k)].push_back({at[0], at[1]});
        }
      }
  }
  return lines;
}

inline double distance_px(const std::vector<TruePoint>& line, double x, double y) {
  double least = 1e9;
  for (const TruePoint& p : line) least = std::min(least, (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y));
  return std::sqrt(least);
}

/// Length of the line in pixels that a drawing of it would take.
inline std::size_t drawn_length(const std::vector<TruePoint>& line) {
  std::vector<std::pair<long, long>> pixels;
  for (const TruePoint& p : line) pixels.emplace_back(std::lround(p.x), std::lround(p.y));
  std::sort(pixels.begin(), pixels.end());
  return static_cast<std::size_t>(std::unique(pixels.begin(), pixels.end()) - pixels.begin());
}

/// Sums over slices.
struct Score {
  double marked = 0, right = 0;     // pixels, and those within the tolerance of the border
  double wanted = 0, found = 0;     // points of the border, and those with a pixel within the tolerance
  double drawn = 0, closeness = 0;  // of Pratt's figure of merit: pixels of a perfect drawing, sum of 1 / (1 + d^2 / 9)
  double offset = 0;                // sum of signed distances, outwards positive

  double precision() const { return marked > 0 ? right / marked : 0; }
  double recall() const { return wanted > 0 ? found / wanted : 0; }
  double f1() const { return precision() + recall() > 0 ? 2 * precision() * recall() / (precision() + recall()) : 0; }
  double pratt() const { return std::max(marked, drawn) > 0 ? closeness / std::max(marked, drawn) : 0; }
  double mean_offset() const { return marked > 0 ? offset / marked : 0; }
  void operator+=(const Score& o) {
    marked += o.marked, right += o.right, wanted += o.wanted, found += o.found;
    drawn += o.drawn, closeness += o.closeness, offset += o.offset;
  }
};

/// One slice. Offsets are measured away from the middle of the line.
inline Score score_slice(const std::vector<image::Pixel>& pixels, const std::vector<TruePoint>& line,
                         double tolerance_px) {
  Score s;
  s.marked = static_cast<double>(pixels.size());
  s.wanted = static_cast<double>(line.size());
  if (line.empty()) return s;
  double cx = 0, cy = 0;
  for (const TruePoint& p : line) cx += p.x / s.wanted, cy += p.y / s.wanted;
  s.drawn = static_cast<double>(drawn_length(line));
  for (const image::Pixel& p : pixels) {
    double least = 1e9;
    TruePoint nearest{};
    for (const TruePoint& q : line) {
      const double d = std::hypot(q.x - p.i, q.y - p.j);
      if (d < least) least = d, nearest = q;
    }
    s.right += least <= tolerance_px;
    s.closeness += 1 / (1 + least * least / 9);
    const bool outside = std::hypot(p.i - cx, p.j - cy) > std::hypot(nearest.x - cx, nearest.y - cy);
    s.offset += outside ? least : -least;
  }
  for (const TruePoint& q : line)
    s.found += std::any_of(pixels.begin(), pixels.end(),
                           [&](const image::Pixel& p) { return std::hypot(q.x - p.i, q.y - p.j) <= tolerance_px; });
  return s;
}

/// The first gate of a phantom, normalised, and its true borders.
struct Scene {
  Image image;
  TrueLines endo, epi;
  int division_slice = -1;  // the highest slice below the cavity
};

inline Scene scene_of(const synthetic::Phantom& phantom) {
  Notes notes;
  Scene scene;
  scene.image = image::normalise(phantom.study.gates.front(), notes);
  const Grid& grid = scene.image.grid;
  scene.endo = true_lines(phantom.truth.front().endo, grid);
  scene.epi = true_lines(phantom.truth.front().epi, grid);
  const auto first = std::find_if(scene.endo.begin(), scene.endo.end(), [](const auto& l) { return !l.empty(); });
  scene.division_slice = static_cast<int>(first - scene.endo.begin()) - 1;
  return scene;
}

}  // namespace dynasurf::experiments
