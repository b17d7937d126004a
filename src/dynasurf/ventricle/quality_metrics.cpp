#include "dynasurf/ventricle/detail/quality_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/mean_point.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/heart/detail/smooth_cycle.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr int rows = 8, around = 24;

template <class F>
void for_each_direction(const heart::LvShell& cup, F&& look) {
  const heart::ShellBasis a = heart::across(cup.axis);
  const double top = heart::base_angle(cup);
  for (int r = 0; r < rows; ++r)
    for (int d = 0; d < around; ++d)
      look(heart::on_cup(cup, a, top * (r + 0.5) / rows, 2 * std::numbers::pi * d / around), r);
}

/// The image along a normal of the wall, from well inside to well outside.
constexpr double step_mm = 1.5;
constexpr int wall_from = -4, wall_to = 5, out_to = 22;  // in steps
std::vector<double> profile_of(const Image& image, const heart::ShellPoint& at) {
  std::vector<double> values;
  for (int s = wall_from; s <= out_to; ++s)
    values.push_back(image::sample_linear(image, at.position + s * step_mm * at.normal));
  return values;
}

double wall_in(const std::vector<double>& profile) {
  return *std::max_element(profile.begin(), profile.begin() + wall_to - wall_from + 1);
}

/// Whether, 10 mm and more beyond the wall, the profile gets nearly as bright as a usual wall without having fallen
/// much on the way.
bool touches_something_hot(const std::vector<double>& profile, double typical) {
  constexpr double as_hot = 0.7, hardly_falls = 0.75;
  const auto wall = std::max_element(profile.begin(), profile.begin() + wall_to - wall_from + 1);
  double valley = *wall;
  for (auto at = wall; at != profile.end(); ++at) {
    valley = std::min(valley, *at);
    const bool is_beyond = at - wall >= 7;
    if (is_beyond && *at >= as_hot * typical && valley >= hardly_falls * std::min(*at, *wall)) return true;
  }
  return false;
}

/// A voxel of the sphere around the heart that is looked at: what lies elsewhere would hide what a gate lacks.
struct Place {
  std::size_t voxel = 0;
  Vec3 position{0, 0, 0};
  double within_mm = 0;  // the sphere
};
std::vector<Place> places_around(const Grid& grid, const heart::LvShell& cup) {
  constexpr double beyond_mm = 15;
  std::vector<Place> places;
  std::size_t voxel = 0;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i, ++voxel) {
        const Vec3 position = centre_of(grid, {i, j, k});
        const double within_mm = cup.half_length_mm + beyond_mm - (position - cup.middle()).norm();
        if (within_mm >= 0) places.push_back({voxel, position, within_mm});
      }
  return places;
}

std::vector<double> counts_of(std::span<const Image> gates, const std::vector<Place>& places) {
  std::vector<double> counts(gates.size(), 0.0);
  parallel_for(counts.size(), 1, [&](std::size_t g, std::size_t) {
    double sum = 0;
    for (const Place& place : places) sum += gates[g].values[place.voxel];
    counts[g] = sum;
  });
  return counts;
}

/// Spread of the distance from the section's own middle, over the middle part of the surface below `top_mm`, where the
/// surface may be closed.
double unroundness(const TriMesh& mesh, const heart::LvShell& cup, double top_mm) {
  const heart::ShellBasis a = heart::across(cup.axis);
  std::vector<Eigen::Vector2d> points;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Vec3& p : mesh.vertices) {
    const Vec3 d = p - cup.centre;
    const double z = d.dot(cup.axis);
    if (z < -0.3 * cup.half_length_mm || z > std::min(0.3 * cup.half_length_mm, top_mm)) continue;
    points.emplace_back(d.dot(a.u), d.dot(a.v));
    middle += points.back();
  }
  if (points.size() < 20) return 0;
  middle /= points.size();
  double sum = 0, squares = 0;
  for (const Eigen::Vector2d& p : points) {
    const double r = (p - middle).norm();
    sum += r, squares += r * r;
  }
  const double n = points.size();
  return sum > 0 ? std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n))) / (sum / n) : 0;
}

constexpr double below_base_mm = 8;

double mean_distance(const TriMesh& mesh, const heart::LvShell& cup) {
  double sum = 0;
  for (const Vec3& p : mesh.vertices) sum += signed_distance(cup, p);
  return sum / mesh.vertices.size();
}

/// Length of a surface along the axis over the width of the ellipsoid that has this length and the surface's volume.
double length_to_width(const Surface& surface, const Vec3& axis) {
  double low = 1e300, high = -1e300;
  for (const Vec3& p : surface.mesh.vertices) low = std::min(low, p.dot(axis)), high = std::max(high, p.dot(axis));
  const double length = high - low;
  // Of an ellipsoid of revolution: volume = pi / 6 length width^2.
  return length / std::sqrt(6000 * surface.volume_ml / (std::numbers::pi * length));
}

double largest_residual(const std::vector<std::optional<double>>& values) {
  constexpr double cut_mm = 6;
  const heart::SmoothCycle smooth = heart::smooth_over_cycle(values, cut_mm);
  double largest = 0;
  for (std::size_t g = 0; g < values.size(); ++g)
    if (values[g]) largest = std::max(largest, std::abs(*values[g] - smooth.values[g]));
  return largest;
}

/// A heart narrows about its axis: across the axis its middle stays, along it moves smoothly.
double largest_move(std::span<const std::optional<Vec3>> middles, const heart::LvShell& cup) {
  const heart::ShellBasis a = heart::across(cup.axis);
  std::vector<double> u, v;
  std::vector<std::optional<double>> along;
  for (const std::optional<Vec3>& middle : middles) {
    if (!middle) {
      along.push_back(std::nullopt);
      continue;
    }
    const Vec3 d = *middle - cup.centre;
    u.push_back(d.dot(a.u)), v.push_back(d.dot(a.v)), along.push_back(d.dot(cup.axis));
  }
  double largest = middles.size() < 4 ? 0 : largest_residual(along);
  const double mean_u = quantile(u, 0.5), mean_v = quantile(v, 0.5);
  for (std::size_t n = 0; n < u.size(); ++n) largest = std::max(largest, own::hypot(u[n] - mean_u, v[n] - mean_v));
  return largest;
}

std::vector<std::optional<Vec3>> middles_of_surfaces(const Result& result) {
  std::vector<std::optional<Vec3>> middles;
  for (const Gate& gate : result.gates) {
    const auto& epi = gate.edge_surfaces.epi;
    middles.push_back(epi && !epi->mesh.vertices.empty() ? std::optional(mean_point(epi->mesh.vertices))
                                                         : std::nullopt);
  }
  return middles;
}

/// Middle of each gate's counts above the background. What stands still beside the heart shortens moves: to about a
/// half behind a camera.
std::vector<std::optional<Vec3>> middles_of_counts(std::span<const Image> gates, const Image& mean,
                                                   const std::vector<Place>& places) {
  constexpr double fades_mm = 10, background_share = 0.3;
  std::vector<std::optional<Vec3>> middles(gates.size());
  if (places.empty()) return middles;
  std::vector<double> values;
  values.reserve(places.size());
  for (const Place& place : places) values.push_back(mean.values[place.voxel]);
  const double background = quantile(values, background_share);
  parallel_for(gates.size(), 1, [&](std::size_t g, std::size_t) {
    double sum = 0;
    Vec3 moment = Vec3::Zero();
    for (const Place& place : places) {
      const double weight = std::min(1.0, place.within_mm / fades_mm);
      const double counts = weight * std::max(0.0, gates[g].values[place.voxel] - background);
      sum += counts;
      moment += counts * place.position;
    }
    if (sum > 0) middles[g] = moment / sum;
  });
  return middles;
}

void look_at_image(const Result& result, const heart::LvShell& world, QualityMetrics& clues) {
  if (result.study.gates.empty()) return;
  const Image mean = heart::mean_image(result.study.gates);
  const heart::LvShell cup = to_grid(mean.grid, world);
  if (heart::share_outside(mean.grid, cup) < 0.5) {
    clues.hot_neighbour = hot_neighbour_share(mean, cup);
    clues.noise = noise_of_wall(result.study.gates, cup);
  }
  if (result.study.gates.size() < 2) return;
  const std::vector<Place> places = places_around(mean.grid, cup);
  const std::vector<double> counts = counts_of(result.study.gates, places);
  const double usual = quantile(counts, 0.5);
  if (!(usual > 0)) return;
  clues.least_counts = *std::min_element(counts.begin(), counts.end()) / usual;
  clues.most_counts = *std::max_element(counts.begin(), counts.end()) / usual;
  clues.counts_move_mm = largest_move(middles_of_counts(result.study.gates, mean, places), cup);
}

void look_at_surfaces(const Result& result, const heart::LvShell& cup, QualityMetrics& clues) {
  double thickness = 0, slimness = 0;
  int outer = 0, both = 0;
  double most_ml = 0;
  for (const Gate& gate : result.gates) {
    if (!gate.edge_surfaces.epi || gate.edge_surfaces.epi->mesh.vertices.empty()) continue;
    const Vec3 base = gate.edge_surfaces.base_plane ? gate.edge_surfaces.base_plane->point : cup.base();
    const double top_mm = (base - cup.centre).dot(cup.axis) - below_base_mm;
    clues.unround = std::max(clues.unround, unroundness(gate.edge_surfaces.epi->mesh, cup, top_mm));
    if (gate.edge_surfaces.epi->volume_ml > 0) slimness += length_to_width(*gate.edge_surfaces.epi, cup.axis), ++outer;
    if (!gate.edge_surfaces.endo || gate.edge_surfaces.endo->mesh.vertices.empty()) continue;
    most_ml = std::max(most_ml, gate.edge_surfaces.endo->volume_ml);
    thickness += mean_distance(gate.edge_surfaces.epi->mesh, cup) - mean_distance(gate.edge_surfaces.endo->mesh, cup),
        ++both;
  }
  if (outer > 0) clues.length_to_width = slimness / outer;
  if (both > 0) clues.thickness_mm = thickness / both;
  if (most_ml > 0)
    clues.bridged =
        (1 - result.heart->ridge_share) * clues.thickness_mm / own::cbrt(3000 * most_ml / (4 * std::numbers::pi));
  clues.surface_moves_mm = largest_move(middles_of_surfaces(result), cup);
}

void look_at_curves(const Result& result, QualityMetrics& clues) {
  std::vector<double> endo, epi;
  for (const Gate& gate : result.gates) {
    if (gate.edge_surfaces.endo) endo.push_back(gate.edge_surfaces.endo->volume_ml);
    if (gate.edge_surfaces.epi) epi.push_back(gate.edge_surfaces.epi->volume_ml);
  }
  const std::size_t gates = result.gates.size();
  if (endo.size() == gates) clues.endo_roughness = heart::cycle_roughness(endo);
  if (epi.size() == gates) clues.epi_roughness = heart::cycle_roughness(epi);
  const Reading& edge = result.readings.edge;
  if (edge.ef_percent && result.readings.gaussian_profile)
    if (const auto other = reading_of(*result.readings.gaussian_profile); other.ef_percent)
      clues.readings_apart = std::abs(other.ef_percent->value - edge.ef_percent->value);
  if (edge.ed_gate && edge.es_gate && gates > 1) clues.end_systole = (*edge.es_gate + 0.5) / gates;
}

void look_at_base(const Result& result, QualityMetrics& clues) {
  double seen = 0, spread = 0, cut = 0;
  int planes = 0;
  for (const Gate& gate : result.gates)
    if (gate.edge_surfaces.base_plane)
      seen += gate.edge_surfaces.base_plane->seen, spread += gate.edge_surfaces.base_plane->spread_mm,
          cut += gate.edge_surfaces.base_plane->cut, ++planes;
  if (planes > 0)
    clues.base_seen = seen / planes, clues.base_spread_mm = spread / planes, clues.base_cut = cut / planes;
}

}  // namespace

double hot_neighbour_share(const Image& image, const heart::LvShell& cup) {
  std::vector<std::vector<double>> profiles;
  std::vector<double> walls;
  for_each_direction(cup, [&](const heart::ShellPoint& at, int) {
    profiles.push_back(profile_of(image, at));
    walls.push_back(wall_in(profiles.back()));
  });
  const double typical = quantile(walls, 0.75);  // not of a defect
  const auto hot = std::count_if(profiles.begin(), profiles.end(),
                                 [&](const auto& profile) { return touches_something_hot(profile, typical); });
  return 1.0 * hot / profiles.size();
}

double noise_of_wall(std::span<const Image> gates, const heart::LvShell& cup) {
  if (gates.size() < 8) return 0;
  std::vector<double> brightness, squares;
  std::vector<std::optional<double>> course(gates.size());
  for_each_direction(cup, [&](const heart::ShellPoint& at, int) {
    double mean = 0;
    for (std::size_t g = 0; g < gates.size(); ++g) {
      course[g] = image::sample_linear(gates[g], at.position);
      mean += *course[g] / gates.size();
    }
    brightness.push_back(mean);
    // No gate is an outlier here: all of the noise counts.
    const heart::SmoothCycle smooth = heart::smooth_over_cycle(course, 1e9);
    double sum = 0;
    for (std::size_t g = 0; g < gates.size(); ++g) sum += own::pow(*course[g] - smooth.values[g], 2);
    // The degrees of freedom that a mean and three waves leave, two waves below twelve gates.
    squares.push_back(sum / (gates.size() >= 12 ? gates.size() - 7 : gates.size() - 5));
  });
  const double typical = quantile(brightness, 0.5);
  return typical > 0 ? std::sqrt(quantile(squares, 0.5)) / typical : 0;
}

QualityMetrics quality_metrics(const Result& result) {
  QualityMetrics clues;
  look_at_curves(result, clues);
  look_at_base(result, clues);
  if (!result.heart) return clues;
  look_at_image(result, result.heart->cup, clues);
  look_at_surfaces(result, result.heart->cup, clues);
  return clues;
}

}  // namespace dynasurf::ventricle
