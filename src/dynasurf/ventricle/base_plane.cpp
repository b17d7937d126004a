#include "dynasurf/ventricle/base_plane.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "dynasurf/image/resample.hpp"

namespace dynasurf {
namespace {

constexpr int meridians = 32;
constexpr double step_mm = 1.5;
constexpr double level_share = 0.5;  // of the wall over its surroundings, where it ends

double quantile(std::vector<double> v, double share) {
  const auto at = v.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(v.size() - 1));
  std::nth_element(v.begin(), at, v.end());
  return *at;
}

/// Distance of the wall's middle from the axis. Over the widest place walls run on more steeply than an ellipsoid.
double wall_radius(const Cup& cup, double z) {
  const double t = z / cup.half_length_mm;
  const double r = cup.radius_mm * std::sqrt(std::max(0.0, 1 - t * t));
  return z > 0 ? std::max(r, 0.7 * cup.radius_mm) : r;
}

/// How bright the wall is along one meridian, from `low` upwards.
struct Meridian {
  Vec3 out;
  double low = 0;
  std::vector<double> brightness;
};

Meridian walk(const Image& image, const Cup& cup, const Vec3& out, double low, double high) {
  Meridian m{out, low, {}};
  constexpr double reach_mm = 7;
  for (double z = low; z <= high; z += step_mm) {
    const double r = wall_radius(cup, z);
    double brightest = 0;
    for (double s = -reach_mm; s <= reach_mm; s += 1.75)
      brightest = std::max(brightest, sample_linear(image, cup.centre + z * cup.axis + std::max(0.0, r + s) * out));
    m.brightness.push_back(brightest);
  }
  return m;
}

/// What surrounds the heart: a low quantile, so that its neighbours do not count.
double surroundings(const Image& image, const Cup& cup, const Across& a) {
  std::vector<double> values;
  for (int d = 0; d < meridians; ++d) {
    const double angle = 2 * std::numbers::pi * d / meridians;
    const Vec3 out = std::cos(angle) * a.u + std::sin(angle) * a.v;
    for (const double z : {-0.3, 0.0, 0.3})
      values.push_back(
          sample_linear(image, cup.centre + z * cup.half_length_mm * cup.axis + (cup.radius_mm + 24) * out));
  }
  return quantile(values, 0.25);
}

/// Height over the cup's centre at which the wall ends on a meridian.
std::optional<double> end_of_wall(const Meridian& m, double from, double background, double typical) {
  const auto first = static_cast<std::size_t>(std::max(0.0, (from - m.low) / step_mm));
  if (first + 2 >= m.brightness.size()) return std::nullopt;
  const double plateau =
      quantile({m.brightness.begin(), m.brightness.begin() + static_cast<std::ptrdiff_t>(first) + 1}, 0.7);
  if (plateau - background < 0.5 * (typical - background)) return std::nullopt;
  const double level = background + level_share * (plateau - background);
  if (m.brightness[first] < level) return std::nullopt;
  for (std::size_t n = first + 1; n < m.brightness.size(); ++n)
    if (m.brightness[n] < level) {
      const double share = (m.brightness[n - 1] - level) / (m.brightness[n - 1] - m.brightness[n]);
      return m.low + (static_cast<double>(n - 1) + share) * step_mm;
    }
  return std::nullopt;
}

struct End {
  double x, y, z;  // along u, v and the axis, mm
};

/// z = p[0] + p[1] x + p[2] y.
Eigen::Vector3d fit_plane(const std::vector<End>& ends) {
  constexpr double noise_mm = 3, usual_tilt = 0.12, cut_mm = 8;
  std::vector<double> heights;
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
    normal(0, 0) += 1e-9, right[0] += 1e-9 * p[0];
    p = normal.ldlt().solve(right);
  }
  return p;
}

/// Least squares of a constant and `waves` waves around the cycle, robust; the value of every gate.
std::vector<double> smooth_periodic(const std::vector<std::optional<double>>& values, int waves,
                                    std::vector<bool>& outlier) {
  const auto n = static_cast<Eigen::Index>(values.size());
  const Eigen::Index terms = 1 + 2 * waves;
  Eigen::MatrixXd basis(n, terms);
  for (Eigen::Index g = 0; g < n; ++g) {
    basis(g, 0) = 1;
    for (int w = 1; w <= waves; ++w) {
      const double angle = 2 * std::numbers::pi * w * static_cast<double>(g) / static_cast<double>(n);
      basis(g, 2 * w - 1) = std::cos(angle), basis(g, 2 * w) = std::sin(angle);
    }
  }
  constexpr double cut_mm = 7;
  Eigen::VectorXd fit = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < 8; ++round) {
    Eigen::MatrixXd normal = 1e-6 * Eigen::MatrixXd::Identity(terms, terms);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
    for (Eigen::Index g = 0; g < n; ++g) {
      const auto& value = values[static_cast<std::size_t>(g)];
      if (!value) continue;
      const double x = round == 0 ? 0 : (*value - fit[g]) / (round < 3 ? 2 * cut_mm : cut_mm);
      if (std::abs(x) >= 1) continue;
      const double weight = (1 - x * x) * (1 - x * x);
      normal += weight * basis.row(g).transpose() * basis.row(g);
      right += weight * *value * basis.row(g).transpose();
    }
    fit = basis * normal.ldlt().solve(right);
  }
  std::vector<double> result;
  for (Eigen::Index g = 0; g < n; ++g) {
    const auto& value = values[static_cast<std::size_t>(g)];
    outlier[static_cast<std::size_t>(g)] = !value || std::abs(*value - fit[g]) > cut_mm;
    result.push_back(fit[g]);
  }
  return result;
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

std::optional<BasePlane> find_base_plane(const Image& image, const Cup& cup) {
  constexpr double least_seen = 1.0 / 3;
  const Across a = across(cup.axis);
  const double low = -0.6 * cup.half_length_mm, high = 1.3 * cup.half_length_mm + 15;
  std::vector<Meridian> all;
  std::vector<double> middle;
  for (int d = 0; d < meridians; ++d) {
    const double angle = 2 * std::numbers::pi * d / meridians;
    all.push_back(walk(image, cup, std::cos(angle) * a.u + std::sin(angle) * a.v, low, high));
    const auto to = static_cast<std::ptrdiff_t>(-low / step_mm);
    middle.push_back(quantile({all.back().brightness.begin(), all.back().brightness.begin() + to + 1}, 0.7));
  }
  const double typical = quantile(middle, 0.6), background = std::min(surroundings(image, cup, a), 0.5 * typical);

  std::vector<End> ends;
  for (const Meridian& m : all)
    if (const auto z = end_of_wall(m, 0, background, typical)) {
      const double r = wall_radius(cup, *z);
      ends.push_back({r * m.out.dot(a.u), r * m.out.dot(a.v), *z});
    }
  const double seen = static_cast<double>(ends.size()) / meridians;
  if (seen < least_seen) return std::nullopt;

  const Eigen::Vector3d p = fit_plane(ends);
  BasePlane plane;
  plane.point = cup.centre + p[0] * cup.axis;
  plane.normal = (cup.axis - p[1] * a.u - p[2] * a.v).normalized();
  plane.seen = seen;
  std::vector<double> away;
  for (const End& e : ends) away.push_back(std::abs(e.z - p[0] - p[1] * e.x - p[2] * e.y));
  plane.spread_mm = quantile(away, 0.5);
  return plane;
}

std::optional<PlaneCycle> smooth_over_cycle(std::span<const std::optional<BasePlane>> planes, const Vec3& axis) {
  const auto found = static_cast<std::size_t>(
      std::count_if(planes.begin(), planes.end(), [](const auto& p) { return p.has_value(); }));
  if (found == 0 || 2 * found < planes.size()) return std::nullopt;

  const auto first = std::find_if(planes.begin(), planes.end(), [](const auto& p) { return p.has_value(); });
  const Vec3 origin = (*first)->point;
  const Across a = across(axis);
  std::vector<std::optional<double>> heights;
  std::vector<double> lean_u, lean_v;
  for (const auto& p : planes) {
    heights.push_back(p ? std::optional((p->point - origin).dot(axis)) : std::nullopt);
    if (!p) continue;
    lean_u.push_back(p->normal.dot(a.u) / p->normal.dot(axis));
    lean_v.push_back(p->normal.dot(a.v) / p->normal.dot(axis));
  }
  const int waves = planes.size() >= 12 ? 3 : planes.size() >= 6 ? 2 : planes.size() >= 4 ? 1 : 0;
  PlaneCycle cycle;
  cycle.outlier.resize(planes.size());
  const std::vector<double> smooth = smooth_periodic(heights, waves, cycle.outlier);
  const Vec3 normal = (axis + quantile(lean_u, 0.5) * a.u + quantile(lean_v, 0.5) * a.v).normalized();
  for (std::size_t g = 0; g < planes.size(); ++g) {
    BasePlane plane = planes[g].value_or(BasePlane{});
    plane.point = origin + smooth[g] * axis;
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

}  // namespace dynasurf
