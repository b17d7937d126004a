#include "dynasurf/heart/base_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/heart/detail/smooth_cycle.hpp"
#include "dynasurf/image/detail/linear_sampler.hpp"
#include "dynasurf/image/intensity.hpp"

namespace dynasurf::heart {
namespace {

constexpr int meridian_count = 32;
constexpr double step_mm = 1.5;

std::vector<double> first_of(std::vector<double> values, std::size_t count) {
  values.resize(std::min(count, values.size()));
  return values;
}

/// Distance of the wall's middle from the axis. Over the widest place walls run on more steeply than an ellipsoid.
double wall_radius(const LvShell& cup, double z) {
  const double t = z / cup.half_length_mm;
  const double r = cup.radius_mm * std::sqrt(std::max(0.0, 1 - t * t));
  return z > 0 ? std::max(r, 0.7 * cup.radius_mm) : r;
}

Meridian walk(const Image& image, const LvShell& cup, const Vec3& out, double low, double high) {
  Meridian m{out, low, {}, false};
  constexpr double reach_mm = 7;
  constexpr std::size_t across = 9;
  const image::LinearSampler value(image);
  for (double z = low; z <= high; z += step_mm) {
    const double r = wall_radius(cup, z);
    const Vec3 middle = cup.centre + z * cup.axis;
    const Index3 v = voxel_of(image.grid, middle + r * out);
    if (!image.grid.contains(v[0], v[1], v[2]) && z > 0) {
      m.is_cut = true;
      break;
    }
    image::SampledPoints<across> points;
    for (std::size_t n = 0; n < across; ++n)
      points.add(middle + std::max(0.0, r + n * (2 * reach_mm / (across - 1)) - reach_mm) * out);
    std::array<double, across> values;
    value(points, values.data());
    m.brightness.push_back(std::max(0.0, *std::max_element(values.begin(), values.end())));
  }
  return m;
}

/// What surrounds the heart: a low quantile, so that its neighbours do not count.
double surroundings(const Image& image, const LvShell& cup, const ShellBasis& a) {
  std::vector<double> values;
  for (int d = 0; d < meridian_count; ++d) {
    const double angle = 2 * std::numbers::pi * d / meridian_count;
    const Vec3 out = own::cos(angle) * a.u + own::sin(angle) * a.v;
    for (const double z : {-0.3, 0.0, 0.3})
      values.push_back(
          image::sample_linear(image, cup.centre + z * cup.half_length_mm * cup.axis + (cup.radius_mm + 24) * out));
  }
  return quantile(values, 0.25);
}

/// Height over the cup's centre at which the wall ends on a meridian.
std::optional<double> end_of_wall(const Meridian& m, double from, double background, double typical,
                                  double level_share) {
  const std::size_t first = std::max(0.0, (from - m.low) / step_mm);
  if (first + 2 >= m.brightness.size()) return std::nullopt;
  const double plateau = quantile(first_of(m.brightness, first + 1), 0.7);
  // In a defect the wall is as dark as its end.
  if (plateau - background < 0.5 * (typical - background)) return std::nullopt;
  const double level = background + level_share * (plateau - background);
  if (m.brightness[first] < level) return std::nullopt;
  for (std::size_t n = first + 1; n < m.brightness.size(); ++n)
    if (m.brightness[n] < level) {
      const double share = (m.brightness[n - 1] - level) / (m.brightness[n - 1] - m.brightness[n]);
      return m.low + ((n - 1) + share) * step_mm;
    }
  return std::nullopt;
}

struct End {
  double x, y, z;  // along u, v and the axis, mm
};

/// z = p[0] + p[1] x + p[2] y. Least squares with Tukey's weights: an end farther than 8 mm off the plane does not
/// count. Tilts are held near 0 by a prior of 0.12, some 7 degrees.
Eigen::Vector3d fit_plane(const std::vector<End>& ends) {
  constexpr double noise_mm = 3, usual_tilt = 0.12, cut_mm = 8;
  std::vector<double> heights;
  heights.reserve(ends.size());
  for (const End& e : ends) heights.push_back(e.z);
  Eigen::Vector3d p(quantile(heights, 0.5), 0, 0);
  for (int round = 0; round < 10; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const End& e : ends) {
      const Eigen::Vector3d row(1, e.x, e.y);
      const double x = (e.z - row.dot(p)) / cut_mm;
      if (std::abs(x) >= 1) continue;
      const double w = (1 - x * x) * (1 - x * x) / (noise_mm * noise_mm);
      normal += w * row * row.transpose();
      right += w * e.z * row;
    }
    normal(1, 1) += 1 / (usual_tilt * usual_tilt), normal(2, 2) += 1 / (usual_tilt * usual_tilt);
    // Where no end is near enough to count, the height stays.
    normal(0, 0) += 1e-9, right[0] += 1e-9 * p[0];
    p = normal.ldlt().solve(right);
  }
  return p;
}

}  // namespace

BasePlane to_world(const Grid& grid, BasePlane plane) {
  plane.point = to_world(grid, plane.point);
  plane.normal = grid.direction * plane.normal;
  return plane;
}

BasePlane to_grid(const Grid& grid, BasePlane plane) {
  plane.point = to_grid(grid, plane.point);
  plane.normal = grid.direction.transpose() * plane.normal;
  return plane;
}

WallProfiles look_at_wall(const Image& image, const LvShell& cup) {
  WallProfiles wall{cup, {}};
  const ShellBasis a = across(cup.axis);
  const double low = -0.6 * cup.half_length_mm, high = 1.3 * cup.half_length_mm + 15;
  const std::size_t below = -low / step_mm;
  std::vector<double> middle;
  for (int d = 0; d < meridian_count; ++d) {
    const double angle = 2 * std::numbers::pi * d / meridian_count;
    wall.meridians.push_back(walk(image, cup, own::cos(angle) * a.u + own::sin(angle) * a.v, low, high));
    const auto& brightness = wall.meridians.back().brightness;
    middle.push_back(quantile(first_of(brightness, below + 1), 0.7));
  }
  wall.typical = quantile(middle, 0.6);
  // Surroundings as bright as the wall would leave it no end to be seen.
  wall.background = std::min(surroundings(image, cup, a), 0.5 * wall.typical);
  return wall;
}

std::optional<BasePlane> find_base_plane(const WallProfiles& wall, double level_share) {
  constexpr double least_seen = 1.0 / 3;
  const LvShell& cup = wall.cup;
  const ShellBasis a = across(cup.axis);
  std::vector<End> ends;
  int cut = 0;
  for (const Meridian& m : wall.meridians) {
    if (const auto z = end_of_wall(m, 0, wall.background, wall.typical, level_share)) {
      const double r = wall_radius(cup, *z);
      ends.push_back({r * m.out.dot(a.u), r * m.out.dot(a.v), *z});
    } else {
      cut += m.is_cut;
    }
  }
  const double seen = 1.0 * ends.size() / meridian_count;
  if (seen < least_seen) return std::nullopt;

  const Eigen::Vector3d p = fit_plane(ends);
  BasePlane plane;
  plane.point = cup.centre + p[0] * cup.axis;
  plane.normal = (cup.axis - p[1] * a.u - p[2] * a.v).normalized();
  plane.seen = seen;
  plane.cut = 1.0 * cut / meridian_count;
  std::vector<double> away;
  away.reserve(ends.size());
  for (const End& e : ends) away.push_back(std::abs(e.z - p[0] - p[1] * e.x - p[2] * e.y));
  plane.spread_mm = quantile(away, 0.5);
  return plane;
}

std::optional<PlaneCycle> smooth_over_cycle(std::span<const std::optional<BasePlane>> planes, const Vec3& axis) {
  const std::size_t found = std::count_if(planes.begin(), planes.end(), [](const auto& p) { return p.has_value(); });
  if (found == 0 || 2 * found < planes.size()) return std::nullopt;

  const auto first = std::find_if(planes.begin(), planes.end(), [](const auto& p) { return p.has_value(); });
  const Vec3 origin = (*first)->point;
  const ShellBasis a = across(axis);
  std::vector<std::optional<double>> heights;
  std::vector<double> lean_u, lean_v;
  for (const auto& p : planes) {
    heights.push_back(p ? std::optional((p->point - origin).dot(axis)) : std::nullopt);
    if (!p) continue;
    // Tangents of the lean, so that their median is a plane again.
    lean_u.push_back(p->normal.dot(a.u) / p->normal.dot(axis));
    lean_v.push_back(p->normal.dot(a.v) / p->normal.dot(axis));
  }
  constexpr double cut_mm = 7;
  const SmoothCycle smooth = smooth_over_cycle(heights, cut_mm);
  PlaneCycle cycle;
  cycle.outlier = smooth.outlier;
  const Vec3 normal = (axis + quantile(lean_u, 0.5) * a.u + quantile(lean_v, 0.5) * a.v).normalized();
  for (std::size_t g = 0; g < planes.size(); ++g) {
    BasePlane plane = planes[g].value_or(BasePlane{});
    plane.point = origin + smooth.values[g] * axis;
    plane.normal = normal;
    cycle.planes.push_back(plane);
  }
  return cycle;
}

TriMesh flatten_above(TriMesh mesh, const BasePlane& plane) {
  for (Vec3& p : mesh.vertices) {
    const double height = plane.height(p);
    if (height > 0) p -= height * plane.normal;
  }
  return mesh;
}

std::optional<double> outward_motion_mm(std::span<const Image> gates, const LvShell& cup) {
  constexpr double smoothing_mm = 3.5, end_level = 0.45;
  constexpr std::size_t least_gates = 6;
  std::vector<std::optional<std::array<double, 2>>> of_gates(gates.size());  // height, brightness
  parallel_for(gates.size(), 1, [&](std::size_t g, std::size_t) {
    const WallProfiles wall = look_at_wall(image::smooth_gaussian(gates[g], smoothing_mm), cup);
    if (const std::optional<BasePlane> plane = find_base_plane(wall, end_level))
      of_gates[g] = {(plane->point - cup.centre).dot(cup.axis), wall.over_surroundings()};
  });
  std::array<double, 2> mean{};
  double seen = 0;
  for (const auto& gate : of_gates)
    if (gate) mean[0] += (*gate)[0], mean[1] += (*gate)[1], ++seen;
  if (seen < least_gates || seen < 0.75 * gates.size()) return std::nullopt;
  double together = 0, brightness = 0;
  for (const auto& gate : of_gates)
    if (gate) {
      const double height = (*gate)[0] - mean[0] / seen, bright = (*gate)[1] - mean[1] / seen;
      together += height * bright, brightness += bright * bright;
    }
  if (!(brightness > 0)) return std::nullopt;
  // From peak to peak of a wave of this covariance.
  return 2 * std::numbers::sqrt2 * together / std::sqrt(brightness * seen);
}

}  // namespace dynasurf::heart
