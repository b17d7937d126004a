#include "dynasurf/psf_fit/detail/setup.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"
#include "dynasurf/psf_fit/detail/wall_terms.hpp"

namespace dynasurf::psf_fit {
namespace {

Pixels pixels_around(const Bounds& box, const Grid& grid, double sigma_mm, double margin_mm) {
  Pixels pixels;
  pixels.spacing = grid.spacing;
  for (int a = 0; a < 3; ++a) {
    // Sharp voxels of 2 mm and less are joined: their edges are known better than a wall is smooth.
    const double wanted = sigma_mm > 0 ? std::max(1.4 * sigma_mm, 3.0) : 4.0;
    const int joined = std::max(1, round_int(wanted / grid.spacing[a]));
    const int from = std::max(0, floor_int((box.low[a] - margin_mm) / grid.spacing[a]));
    const int to = std::min(grid.dims[a] - 1, ceil_int((box.high[a] + margin_mm) / grid.spacing[a]));
    pixels.joined[a] = joined;
    pixels.first[a] = from;
    pixels.count[a] = std::max(0, (to - from + 1) / joined);
  }
  return pixels;
}

CellLattice lattice_around(const Bounds& box, const Pixels& pixels, double sigma_mm, double margin_mm) {
  CellLattice lattice;
  double pitch[3], finest = 1e9;
  for (int a = 0; a < 3; ++a) {
    pitch[a] = pixels.spacing[a] * pixels.joined[a];
    finest = std::min(finest, pitch[a]);
  }
  const double wanted = std::max(0.7 * sigma_mm, std::min(0.5 * finest, 2.0));
  for (int a = 0; a < 3; ++a) {
    // Sharp images want whole cells in every voxel, two in a joined one.
    constexpr double sharp_mm = 2.3;
    lattice.step[a] = 0.7 * sigma_mm > std::min(0.5 * finest, 2.0)
                          ? wanted
                          : pitch[a] / std::ceil(pitch[a] / (sigma_mm > 0 ? wanted : sharp_mm) - 1e-9);
    const double edge = pixels.centre(a, 0) - pitch[a] / 2;
    const double from = std::floor((box.low[a] - margin_mm - edge) / lattice.step[a]);
    const double to = std::ceil((box.high[a] + margin_mm - edge) / lattice.step[a]);
    lattice.start[a] = edge + (from + 0.5) * lattice.step[a];
    lattice.count[a] = std::max<int>(1, to - from);
  }
  lattice.edge_mm = 0.5 * lattice.step.maxCoeff();
  if (sigma_mm > 0) lattice.edge_mm = std::min(lattice.edge_mm, 0.5 * sigma_mm);
  return lattice;
}

/// The outermost of a wall over the beat, as harmonics of log q.
Eigen::VectorXd outermost(const PlacedStart& start, int degree) {
  Eigen::VectorXd most;
  double volume = 0;
  for (std::size_t g = 0; g < start.epi.size(); ++g) {
    const double v = mesh::volume_mm3(start.epi[g]);
    if (most.size() > 0 && v <= volume) continue;
    most = harmonics_of_surface(start.epi[g], start.frame, start.base[g], degree);
    volume = v;
  }
  return most;
}

/// Where every pixel lies against the wall at the start: `outer` is the log of its outer surface in harmonics.
std::vector<Place> places_of(const Pixels& pixels, const HeartFrame& frame, const Eigen::VectorXd& outer,
                             int outer_degree, double highest_mm) {
  std::vector<Place> places;
  const Index3 dims = pixels.count;
  places.resize(pixels.size());
  parallel_for(dims[2], 1, [&](std::size_t k, std::size_t) {
    std::vector<double> harmonics(harmonics_up_to(outer_degree));
    Place* place = places.data() + k * dims[0] * dims[1];
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i, ++place) {
        const Vec3 heart = frame.to_heart({pixels.centre(0, i), pixels.centre(1, j), pixels.centre(2, k)});
        const Vec3 scaled = heart.cwiseQuotient(frame.scale);
        const double q = std::max(1e-6, scaled.norm());
        real_spherical_harmonics(scaled / q, outer_degree, harmonics);
        double wall = 0;
        for (int h = 0; h < harmonics_up_to(outer_degree); ++h) wall += outer[h] * harmonics[h];
        place->outside_mm = (q - own::exp(wall)) / (scaled / q).cwiseQuotient(frame.scale).norm();
        place->above_mm = heart[2] - highest_mm;
        place->depth = q / own::exp(wall);
      }
  });
  return places;
}

/// Usual values of muscle, surroundings and cavity in the mean image of the beat; `margin`: mm around the heart.
void measure_brightness(Setup& s, const std::vector<double>& mean, double margin) {
  std::vector<double> wall, around, inside;
  for (std::size_t n = 0; n < mean.size(); ++n) {
    const Place& place = s.place[n];
    if (place.above_mm < 0 && place.outside_mm < 0 && place.depth > 0.5) wall.push_back(mean[n]);
    if (place.above_mm < 0 && place.outside_mm > 0.5 * margin && place.outside_mm < margin) around.push_back(mean[n]);
    if (place.above_mm < -5 && place.depth < 0.3) inside.push_back(mean[n]);
  }
  s.healthy = std::max(1e-12, quantile(wall, 0.9));
  s.unit = 1.1 * s.healthy;
  s.background = quantile(around, 0.25) / s.unit;
  s.cavity = quantile(inside, 0.5) / s.unit;
}

/// What a pixel counts for before outliers lose their weight; nothing beyond the margin.
void weigh_pixels(Setup& s, const std::vector<double>& mean, const Blur& blur, double margin) {
  BeatProblem& p = s.problem;
  p.weight.resize(mean.size());
  for (std::size_t n = 0; n < mean.size(); ++n) {
    const Place& place = s.place[n];
    const bool looked_at = place.outside_mm < margin && place.above_mm < margin;
    // Counts are as uncertain as they are many; the noise of sharp images, MR and CT, is the same everywhere.
    const double variance = blur.fwhm_mm > 0 ? std::max(mean[n] / s.unit, 0.1) : 1;
    p.weight[n] = looked_at ? 1 / variance : 0;
  }
}

/// Takes the weight of pixels that reach outside a region.
void leave_out(const Mask& looked_at, BeatProblem& p) {
  Image region(looked_at.grid);
  std::transform(looked_at.values.begin(), looked_at.values.end(), region.values.begin(),
                 [](std::uint8_t v) { return v > 0 ? 1.0F : 0.0F; });
  const std::vector<float> share = join(region, p.pixels);
  for (std::size_t n = 0; n < p.weight.size(); ++n)
    if (share[n] < 1) p.weight[n] = 0;
}

}  // namespace

Bounds bounds_of(const std::vector<TriMesh>& meshes) {
  Bounds box;
  for (const TriMesh& mesh : meshes)
    for (const Vec3& p : mesh.vertices) box.low = box.low.cwiseMin(p), box.high = box.high.cwiseMax(p);
  return box;
}

Setup set_up(const Study& study, const PlacedStart& start, const Blur& blur, const BlurFit& options) {
  Setup s;
  BeatProblem& p = s.problem;
  const Grid& grid = study.grid();
  p.sigma_mm = blur.fwhm_mm / sigmas_per_fwhm;
  // Where voxels are finer than the blur, it does not matter whether it came before or after them.
  p.filtered = grid.spacing.maxCoeff() > 1.2 * p.sigma_mm ? blur.filtered : 0;
  constexpr double room = 9;  // mm, for an outer wall that lies farther out than at the start
  const double margin = std::max(0.8 * blur.fwhm_mm, 1.5 * grid.spacing.maxCoeff()) + room / 2;
  const Bounds box = bounds_of(start.epi);
  p.pixels = pixels_around(box, grid, p.sigma_mm, margin);
  const CellLattice lattice = lattice_around(box, p.pixels, p.sigma_mm, room);
  constexpr int outer_degree = 4;
  const Eigen::VectorXd outer = outermost(start, outer_degree);
  for (const heart::BasePlane& base : start.base)
    s.highest_mm = std::max(s.highest_mm, start.frame.to_heart(base.point)[2]);
  const int degree = std::max({options.shape_degree, options.wall_degree, options.uptake_degree});
  p.cells = select_cells(lattice, start.frame, degree, s.highest_mm + 10, outer, outer_degree, room);

  s.place = places_of(p.pixels, start.frame, outer, outer_degree, s.highest_mm);
  const double gates = study.gates.size();
  std::vector<double> mean(p.pixels.size(), 0.0);
  for (const Image& gate : study.gates) {
    p.values.push_back(join(gate, p.pixels));
    for (std::size_t n = 0; n < mean.size(); ++n) mean[n] += p.values.back()[n] / gates;
  }
  measure_brightness(s, mean, margin);
  for (auto& values : p.values)
    for (float& v : values) v /= s.unit;
  p.thickness = thickness_prior(start, degree, options);
  p.points = placed_points(start, degree);
  weigh_pixels(s, mean, blur, margin);
  if (start.looked_at) leave_out(*start.looked_at, p);
  return s;
}

}  // namespace dynasurf::psf_fit
