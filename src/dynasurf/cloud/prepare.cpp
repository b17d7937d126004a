#include "dynasurf/cloud/detail/prepare.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <Eigen/Cholesky>

#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/cloud/detail/outliers.hpp"
#include "dynasurf/core/detail/mean_point.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/detail/symmetric_axes.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t fewest_points = 10;

template <class T>
void keep(std::vector<T>& values, const std::vector<std::uint8_t>& kept) {
  if (values.empty()) return;
  std::size_t n = 0;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i]) values[n++] = values[i];
  values.resize(n);
}

/// Drops what is not kept, and returns how many that were.
std::size_t keep(PointCloud& cloud, const std::vector<std::uint8_t>& kept) {
  const std::size_t before = cloud.points.size();
  keep(cloud.points, kept);
  keep(cloud.normals, kept);
  keep(cloud.colours, kept);
  keep(cloud.scans, kept);
  return before - cloud.points.size();
}

template <class T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  if (values.empty()) return;
  std::vector<T> moved;
  moved.reserve(order.size());
  for (const std::uint32_t i : order) moved.push_back(values[i]);
  values = std::move(moved);
}

/// What belongs to the points follows them.
void reorder_others(PointCloud& cloud, const std::vector<std::uint32_t>& order) {
  reorder(cloud.normals, order);
  reorder(cloud.colours, order);
  reorder(cloud.scans, order);
}

std::uint64_t hash_of(const Vec3& p) {
  std::uint64_t h = 0;
  for (int a = 0; a < 3; ++a) {
    h ^= std::bit_cast<std::uint64_t>(p[a] + 0.0);  // -0 is 0
    h *= 0x9e3779b97f4a7c15u;
    h ^= h >> 29;
  }
  return h;
}

/// 1 for the first of all points in one place.
std::vector<std::uint8_t> firsts(const std::vector<Vec3>& points) {
  const std::size_t slots = std::bit_ceil(2 * points.size() + 1);
  constexpr std::uint32_t empty = 0xffffffff;
  std::vector<std::uint32_t> table(slots, empty);
  std::vector<std::uint8_t> kept(points.size(), 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t at = hash_of(points[i]) & (slots - 1);
    while (table[at] != empty && points[table[at]] != points[i]) at = (at + 1) & (slots - 1);
    if (table[at] == empty)
      table[at] = i;
    else
      kept[i] = 0;
  }
  return kept;
}

/// How neighbours lie off the best height function of second degree over their own plane.
struct OffQuadric {
  double rms = 0;
  double kurtosis = 3;
  double rms_of_layers = 0;  // where those above it and those below have a height each
};

template <int terms>
using Row = Eigen::Matrix<double, terms, 1>;

template <int terms>
struct LeastSquares {
  Row<terms> solution;
  double left_over = 0;  // sum of squares
};

template <int terms>
LeastSquares<terms> least_squares(const std::vector<Row<terms>>& rows, const std::vector<double>& values) {
  Eigen::Matrix<double, terms, terms> normal = Eigen::Matrix<double, terms, terms>::Identity() * 1e-12;
  Row<terms> right = Row<terms>::Zero();
  double squares = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int r = 0; r < terms; ++r)  // of the symmetric matrix, the half that is looked at
      for (int c = 0; c <= r; ++c) normal(r, c) += rows[i][r] * rows[i][c];
    right += rows[i] * values[i];
    squares += values[i] * values[i];
  }
  const Row<terms> solution = normal.ldlt().solve(right);
  return {solution, std::max(0.0, squares - right.dot(solution))};
}

/// Sum of squares that is left over where the points above the function and those below it have a height each.
double left_over_by_layers(const std::vector<Row<6>>& rows, const std::vector<double>& heights, const Row<6>& one) {
  std::vector<Row<7>> sided(rows.size());
  Row<7> solution;
  solution << one, 0;
  double left_over = 0;
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double above = heights[i] - rows[i].dot(solution.head<6>());
      sided[i] << rows[i], above > 0 ? 1 : -1;
    }
    const LeastSquares<7> fit = least_squares<7>(sided, heights);
    solution = fit.solution, left_over = fit.left_over;
  }
  return left_over;
}

OffQuadric off_quadric(const std::vector<Vec3>& points, std::span<const KdTree::Found> found) {
  const double n = found.size();
  Vec3 middle = Vec3::Zero();
  for (const auto& f : found) middle += points[f.index] / n;
  Mat3 spread = Mat3::Zero();
  for (const auto& f : found) spread += (points[f.index] - middle) * (points[f.index] - middle).transpose() / n;
  const SymmetricAxes axes = symmetric_axes(spread);
  const double size = std::sqrt(std::max(axes.values[2], 1e-300));
  std::vector<Row<6>> rows;
  std::vector<double> heights;
  for (const auto& f : found) {
    const Vec3 q = axes.directions.transpose() * (points[f.index] - middle) / size;
    rows.push_back(Row<6>{1, q[1], q[2], q[1] * q[1], q[1] * q[2], q[2] * q[2]});
    heights.push_back(q[0]);
  }
  const LeastSquares<6> fit = least_squares<6>(rows, heights);
  OffQuadric off;
  off.rms = off.rms_of_layers = size * std::sqrt(fit.left_over / (n - 6));
  double fourth = 0, second = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double away = heights[i] - rows[i].dot(fit.solution), square = away * away;
    second += square / n;
    fourth += square * square / n;
  }
  if (second > 0) off.kurtosis = fourth / (second * second);
  constexpr double hardly_layers = 2.2;
  if (off.kurtosis < hardly_layers)
    off.rms_of_layers = size * std::sqrt(left_over_by_layers(rows, heights, fit.solution) / (n - 7));
  return off;
}

constexpr std::array<std::size_t, 4> neighbourhoods{16, 24, 48, 100};

/// The medians of each over the cloud, for the first so many of the `neighbourhoods`.
std::vector<OffQuadric> medians_off_quadric(const std::vector<Vec3>& points, const KdTree& neighbours,
                                            std::size_t sizes) {
  constexpr std::size_t samples = 1500;
  const std::size_t step = std::max<std::size_t>(1, points.size() / samples);
  std::vector<std::array<OffQuadric, neighbourhoods.size()>> off((points.size() + step - 1) / step);
  parallel_for(off.size(), 64, [&](std::size_t begin, std::size_t end) {
    // Nearest first: a small neighbourhood is the beginning of a large one.
    std::vector<KdTree::Found> found(neighbourhoods[sizes - 1]);
    for (std::size_t i = begin; i < end; ++i) {
      neighbours.nearest(points[i * step], found);
      for (std::size_t n = 0; n < sizes; ++n)
        off[i][n] = off_quadric(points, std::span(found).first(neighbourhoods[n]));
    }
  });
  std::vector<OffQuadric> medians(sizes);
  for (std::size_t n = 0; n < sizes; ++n)
    for (double OffQuadric::*const part : {&OffQuadric::rms, &OffQuadric::kurtosis, &OffQuadric::rms_of_layers}) {
      std::vector<double> all;
      for (const auto& o : off) all.push_back(o[n].*part);
      medians[n].*part = upper_median(std::move(all));
    }
  return medians;
}

/// Side of the square that a point stands for, from the circle that holds its neighbours.
double median_spacing(const std::vector<Vec3>& points, const KdTree& neighbours) {
  constexpr std::size_t samples = 3000;
  const std::size_t step = std::max<std::size_t>(1, points.size() / samples);
  std::vector<double> side((points.size() + step - 1) / step);
  parallel_for(side.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::array<KdTree::Found, 13> found;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t n = neighbours.nearest(points[i * step], found);
      side[i] = std::sqrt(std::numbers::pi * found[n - 1].distance2 / (n - 1));
    }
  });
  return upper_median(std::move(side));
}

/// Standard deviation of the points off the surface, after what `count` neighbours leave over of a parabola. Those of a
/// noisy point are not those of its place: less than the noise is left over, by a share that depends on the number of
/// neighbours in a square as large as the noise, q / (q + 8) on all bodies that were measured. Nothing where the
/// neighbours lie within the noise.
std::optional<double> noise_from(double left_over, std::size_t count, double spacing) {
  constexpr double lost = 8, fewest = 12;
  const double squares = count * spacing * spacing;
  const double root2 = squares * squares - 4 * lost * left_over * left_over * squares;
  if (!(root2 >= 0)) return std::nullopt;
  if (!(left_over > 0)) return 0;
  const double noise = (squares - std::sqrt(root2)) / (2 * lost * left_over);
  return squares > fewest * noise * noise ? std::optional(noise) : std::nullopt;
}

struct Noise {
  double size = 0;
  double kurtosis = 3;  // of a normal distribution, unless enough neighbours tell
};

/// The shape of the body and the other side of a wall only add to it, so the smallest counts. Both sides of a wall as
/// thin as the points lie apart look like noise, but have two heights and little between them: the kurtosis is 2.7 to 3
/// of normal noise, 1.9 to 2 of noise that is the same everywhere between two bounds, and 1.2 to 1.6 of two layers.
Noise estimate_noise(const std::vector<Vec3>& points, const KdTree& neighbours, double spacing) {
  constexpr double of_layers = 1.75;
  constexpr std::size_t enough_for_layers = 48;
  double least = std::numeric_limits<double>::infinity(), left_over = 0;
  Noise noise;
  std::size_t sizes = 0;
  while (sizes < neighbourhoods.size() && points.size() >= 2 * neighbourhoods[sizes]) ++sizes;
  const std::vector<OffQuadric> medians =
      sizes > 0 ? medians_off_quadric(points, neighbours, sizes) : std::vector<OffQuadric>{};
  for (std::size_t n = 0; n < sizes; ++n) {
    const std::size_t count = neighbourhoods[n];
    const OffQuadric& off = medians[n];
    const bool is_layered = count >= enough_for_layers && off.kurtosis < of_layers;
    left_over = is_layered ? off.rms_of_layers : off.rms;
    if (const auto size = noise_from(left_over, count, spacing)) least = std::min(least, *size);
    if (count >= enough_for_layers && !is_layered) noise.kurtosis = off.kurtosis;
  }
  noise.size = std::isfinite(least) ? least : 2 * left_over;
  return noise;
}

/// Layers that noise hides, and yet flatter than noise around one surface.
void tell_layers(const Facts& facts, double kurtosis, Notes& notes) {
  constexpr double flat = 2.5;
  if (!is_noisy(facts) || kurtosis > flat) return;
  notes.push_back(
      {Severity::warning, "cloud.layers",
       "the points lie in two layers rather than around one surface: a wall about as thin as their noise may "
       "be lost"});
}

void check_shape(const PointCloud& cloud) {
  const std::size_t n = cloud.points.size();
  for (const std::size_t other : {cloud.normals.size(), cloud.colours.size(), cloud.scans.size()})
    if (other != 0 && other != n)
      throw InputError("the cloud has " + std::to_string(n) + " points, but " + std::to_string(other) +
                       " normals, colours or scan numbers; expected none or as many");
  const std::uint32_t last = cloud.scans.empty() ? 0 : *std::max_element(cloud.scans.begin(), cloud.scans.end());
  if (!cloud.scanners.empty() && last >= cloud.scanners.size())
    throw InputError("the cloud has " + std::to_string(cloud.scanners.size()) + " scanners' places, but a scan " +
                     std::to_string(last) + "; expected none or one for each scan");
  if (n >= 0xffffffff) throw InputError("the cloud has " + std::to_string(n) + " points; expected fewer than 2^32 - 1");
}

void check_count(const std::vector<Vec3>& points) {
  if (points.size() < fewest_points)
    throw InputError("the cloud has " + std::to_string(points.size()) + " usable points; expected " +
                     std::to_string(fewest_points) + " at least");
}

void check_extent(const std::vector<Vec3>& points) {
  const Vec3 middle = mean_point(points);
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : points) spread += (p - middle) * (p - middle).transpose();
  const Vec3 axes = symmetric_axes(spread).values;
  if (!(axes[0] > 1e-12 * axes[2])) throw InputError("the points of the cloud all lie in one plane; expected a body");
}

void note(Notes& notes, std::size_t count, const char* code, const std::string& what) {
  if (count > 0) notes.push_back({Severity::info, code, std::to_string(count) + " points " + what});
}

}  // namespace

void note_outliers(std::size_t count, Notes& notes) {
  note(notes, count, "cloud.outliers", "stand alone, far from all others; they were left out");
}

bool is_noisy(const Facts& f) { return f.noise > 0.3 * f.spacing; }

PreparedCloud prepare(PointCloud cloud, const Options& options, const Progress& progress) {
  check_shape(cloud);
  Facts facts;
  facts.points = cloud.points.size();
  std::vector<std::uint8_t> kept(cloud.points.size());
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = cloud.points[i].allFinite();
  facts.not_finite = keep(cloud, kept);
  facts.duplicates = keep(cloud, firsts(cloud.points));
  check_count(cloud.points);
  progress.check();
  std::vector<std::uint32_t> had;
  std::optional<TraceStage> noted(std::in_place, "points: tree");
  KdTree neighbours(cloud.points, had);
  reorder_others(cloud, had);
  PreparedCloud p{std::move(cloud), std::move(neighbours), facts, {}};
  PointCloud& c = p.cloud;
  progress.check();
  noted.emplace("points: outliers");
  if (options.outliers > 0 && c.points.size() > 4 * stray_ring) {
    kept = parts_of_surfaces(c.points, p.neighbours, options.outliers);
    p.facts.outliers = keep(c, kept);
    if (p.facts.outliers > 0) p.neighbours.keep(kept, c.points);
    check_count(c.points);
  }
  noted.emplace("points: noise");
  check_extent(c.points);  // not before: one point far enough away makes a line of all others
  progress.check();
  Eigen::AlignedBox3d box;
  for (const Vec3& q : c.points) box.extend(q);
  p.facts.points_used = c.points.size();
  p.facts.diagonal = box.diagonal().norm();
  p.facts.spacing = median_spacing(c.points, p.neighbours);
  if (options.noise_percent) {
    p.facts.noise = *options.noise_percent / 100 * p.facts.diagonal;
  } else {
    const Noise noise = estimate_noise(c.points, p.neighbours, p.facts.spacing);
    p.facts.noise = noise.size;
    tell_layers(p.facts, noise.kurtosis, p.notes);
  }
  note(p.notes, p.facts.not_finite, "cloud.not_finite",
       "have a coordinate that is not a finite number; they were left out");
  note(p.notes, p.facts.duplicates, "cloud.duplicates", "lie exactly where another one lies; they were left out");
  note_outliers(p.facts.outliers, p.notes);
  return p;
}

}  // namespace dynasurf::cloud
