#include "dynasurf/heart/detail/lv_shell.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/image/detail/linear_sampler.hpp"

namespace dynasurf::heart {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double least_radius_mm = 12, most_radius_mm = 60;
constexpr double least_elongation = 1.0, usual_elongation = 1.9, most_elongation = 2.8;
constexpr double side_mm = 14;  // beside the wall: beyond its half thickness and the blur

/// An angle around the axis.
struct Turn {
  double cosine, sine;
};
Turn turn_by(double phi) { return {own::cos(phi), own::sin(phi)}; }

/// Unit vector square to the axis.
Vec3 outwards(const ShellBasis& a, const Turn& turn) { return turn.cosine * a.u + turn.sine * a.v; }

/// Those of a score, all the way around in equal steps.
constexpr std::size_t around = 12;
struct Sides {
  std::array<double, around> x, y, z;
};
Sides sides_of(const ShellBasis& a) {
  static const std::array<Turn, around> turns = [] {
    std::array<Turn, around> all{};
    for (std::size_t d = 0; d < around; ++d) all[d] = turn_by(2 * pi * d / around);
    return all;
  }();
  Sides sides;
  for (std::size_t d = 0; d < around; ++d) {
    const Vec3 out = outwards(a, turns[d]);
    sides.x[d] = out[0], sides.y[d] = out[1], sides.z[d] = out[2];
  }
  return sides;
}

/// The height of a row of points: theta from the apex.
struct Row {
  double sine, cosine;
};
Row row_at(double theta) { return {own::sin(theta), own::cos(theta)}; }

/// The point of the ellipsoid on the side of `out`.
ShellPoint on_cup(const LvShell& cup, const Vec3& out, const Row& row) {
  const auto [s, c] = row;
  const Vec3 position = cup.centre + cup.radius_mm * s * out - cup.half_length_mm * c * cup.axis;
  const Vec3 normal = (s / cup.radius_mm * out - c / cup.half_length_mm * cup.axis).normalized();
  return {position, normal};
}

/// Where coordinates of points are put, one after the other.
struct Coordinates {
  double *x, *y, *z;
};

/// `on_cup` of all sides of a row, for any instruction set: points inside the wall, `apart` places on those outside it,
/// and as much farther those in its middle.
DYNASURF_CLONES
void look_across(const LvShell& cup, const Sides& sides, const Row& row, double inwards, const Coordinates& to,
                 std::size_t apart) {
  const double from_axis = cup.radius_mm * row.sine, along = cup.half_length_mm * row.cosine;
  const double across_part = row.sine / cup.radius_mm, along_part = row.cosine / cup.half_length_mm;
  const double ax = cup.axis[0], ay = cup.axis[1], az = cup.axis[2];
  const double cx = cup.centre[0], cy = cup.centre[1], cz = cup.centre[2];
  double* const __restrict to_x = to.x, * const __restrict to_y = to.y, * const __restrict to_z = to.z;
  for (std::size_t d = 0; d < around; ++d) {
    const double x = cx + from_axis * sides.x[d] - along * ax, nx = across_part * sides.x[d] - along_part * ax;
    const double y = cy + from_axis * sides.y[d] - along * ay, ny = across_part * sides.y[d] - along_part * ay;
    const double z = cz + from_axis * sides.z[d] - along * az, nz = across_part * sides.z[d] - along_part * az;
    const double length = std::sqrt(nx * nx + (ny * ny + nz * nz));
    const double ux = nx / length, uy = ny / length, uz = nz / length;
    to_x[d] = x - inwards * ux, to_y[d] = y - inwards * uy, to_z[d] = z - inwards * uz;
    to_x[apart + d] = x + side_mm * ux, to_y[apart + d] = y + side_mm * uy, to_z[apart + d] = z + side_mm * uz;
    to_x[2 * apart + d] = x, to_y[2 * apart + d] = y, to_z[2 * apart + d] = z;
  }
}

Vec3 turned(const Vec3& axis, const Vec3& towards, double angle) {
  return (axis + own::tan(angle) * towards).normalized();
}

bool plausible(const LvShell& c) {
  const double elongation = c.half_length_mm / c.radius_mm;
  return c.radius_mm >= least_radius_mm && c.radius_mm <= most_radius_mm && elongation >= least_elongation &&
         elongation <= most_elongation && c.base_mm >= 0.1 * c.half_length_mm && c.base_mm <= 0.9 * c.half_length_mm;
}

bool is_inside(const Grid& grid, const Vec3& p) {
  const Index3 v = voxel_of(grid, p);
  return grid.contains(v[0], v[1], v[2]);
}

/// The cup moved by small amounts: centre (3), tilt of the axis (2), radius, half length.
LvShell moved(LvShell cup, const Eigen::Matrix<double, 7, 1>& by) {
  const ShellBasis a = across(cup.axis);
  cup.centre += by.head<3>();
  cup.axis = (cup.axis + by[3] * a.u + by[4] * a.v).normalized();
  cup.radius_mm += by[5];
  cup.half_length_mm += by[6];
  return cup;
}

}  // namespace

ShellBasis across(const Vec3& axis) {
  const Vec3 helper = std::abs(axis[0]) < 0.7 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 u = (helper - helper.dot(axis) * axis).normalized();
  return {u, axis.cross(u)};
}

ShellPoint on_cup(const LvShell& cup, const ShellBasis& a, double theta, double phi) {
  return on_cup(cup, outwards(a, turn_by(phi)), row_at(theta));
}

double base_angle(const LvShell& cup) { return own::acos(std::clamp(-cup.base_mm / cup.half_length_mm, -0.98, 0.98)); }

double volume_mm3(const LvShell& cup) {
  const double height = std::clamp(cup.base_mm / cup.half_length_mm, -1.0, 1.0);
  return std::numbers::pi * cup.radius_mm * cup.radius_mm * cup.half_length_mm *
         (2.0 / 3 + height - height * height * height / 3);
}

double signed_distance(const LvShell& cup, const Vec3& p) {
  const Vec3 d = p - cup.centre;
  const double z = d.dot(cup.axis);
  const double rho2 = std::max(0.0, d.squaredNorm() - z * z);
  const double r2 = cup.radius_mm * cup.radius_mm, l2 = cup.half_length_mm * cup.half_length_mm;
  const double level = std::sqrt(rho2 / r2 + z * z / l2);
  const double gradient = std::sqrt(rho2 / (r2 * r2) + z * z / (l2 * l2)) / std::max(level, 1e-9);
  return gradient > 0 ? (level - 1) / gradient : -cup.radius_mm;
}

LvShell to_world(const Grid& grid, LvShell cup) {
  cup.centre = to_world(grid, cup.centre);
  cup.axis = grid.direction * cup.axis;
  return cup;
}

LvShell to_grid(const Grid& grid, LvShell cup) {
  cup.centre = to_grid(grid, cup.centre);
  cup.axis = grid.direction.transpose() * cup.axis;
  return cup;
}

CupScore score(const Image& image, const LvShell& cup) {
  constexpr std::size_t rows = 5, points = rows * around + 1, over_base = around + 1;
  const ShellBasis a = across(cup.axis);
  const Sides sides = sides_of(a);
  const double top = base_angle(cup), inwards = std::min(side_mm, 0.9 * cup.radius_mm);
  image::SampledPoints<3 * points + over_base> at;  // inside, outside, in the wall, then over the base
  at.count = 3 * points + over_base;
  const ShellPoint apex = on_cup(cup, a.u, row_at(0));
  at.put(0, apex.position - inwards * apex.normal);
  at.put(points, apex.position + side_mm * apex.normal);
  at.put(2 * points, apex.position);
  for (std::size_t r = 0; r < rows; ++r) {
    const std::size_t first = 1 + r * around;
    const Row row = row_at(top * (r + 0.75) / rows);
    look_across(cup, sides, row, inwards, {&at.x[first], &at.y[first], &at.z[first]}, points);
  }
  at.put(3 * points, cup.base() + 8 * cup.axis);
  const Row rim = row_at(std::min(top, 2.6));
  for (std::size_t d = 0; d < around; ++d) {
    const Vec3 out(sides.x[d], sides.y[d], sides.z[d]);
    at.put(3 * points + 1 + d, on_cup(cup, out, rim).position + 14 * cup.axis);
  }
  std::array<double, 3 * points + over_base> value;
  image::LinearSampler{image}(at, value.data());

  std::array<double, points> wall, side;
  for (std::size_t n = 0; n < points; ++n) {
    const double in = value[n], outside = value[points + n];
    wall[n] = value[2 * points + n];
    side[n] = 0.75 * std::max(in, outside) + 0.25 * std::min(in, outside);
  }
  CupScore result;
  result.brightness = upper_median(std::vector<double>(wall.begin(), wall.end()));
  const double most = 1.15 * result.brightness;
  double sum = 0;
  for (std::size_t n = 0; n < points; ++n) sum += std::clamp(std::min(wall[n], most) - side[n], -0.5 * most, most);
  result.contrast = sum / points;

  // Over the base there is no wall: neither where it would go on nor in the middle.
  double over = 0;
  for (std::size_t n = 3 * points; n < value.size(); ++n) over += value[n];
  const double open = result.brightness - std::min(over / over_base, most);
  result.contrast = 0.75 * result.contrast + 0.25 * open;
  return result;
}

LvShell local_search(const Image& image, LvShell cup, double step_mm, double last_mm) {
  double best = score(image, cup).contrast;
  constexpr int passes = 6;
  for (double step = step_mm; step >= last_mm; step /= 2) {
    int still = 0;  // ways in a row in which nothing rose: after both, all others would be the same again
    for (int n = 0; n < 2 * passes && still < 2; ++n) {
      bool rose = false;
      const auto attempt = [&](const LvShell& candidate) {
        if (!plausible(candidate)) return;
        const double value = score(image, candidate).contrast;
        if (value > best) best = value, cup = candidate, rose = true;
      };
      const double way = n % 2 == 0 ? step : -step;
      LvShell c = cup;
      const ShellBasis a = across(cup.axis);
      for (const Vec3& direction : {a.u, a.v, cup.axis}) c = cup, c.centre += way * direction, attempt(c);
      for (const Vec3& direction : {a.u, a.v}) {
        c = cup, c.axis = turned(cup.axis, direction, way / cup.half_length_mm);
        attempt(c);
        // About the apex as well: the base swings, the apex stays.
        c.centre = cup.apex() + cup.half_length_mm * c.axis;
        attempt(c);
      }
      c = cup, c.radius_mm += way, attempt(c);
      c = cup, c.half_length_mm += way, attempt(c);
      c = cup, c.radius_mm += way, c.half_length_mm += way, attempt(c);
      c = cup, c.base_mm += way, attempt(c);
      still = rose ? 0 : still + 1;
    }
  }
  return cup;
}

double share_outside(const Grid& grid, const LvShell& cup) {
  constexpr int rows = 8, around = 24;
  constexpr double half_wall_mm = 5;
  const ShellBasis a = across(cup.axis);
  const double top = base_angle(cup);
  int outside = 0;
  for (int r = 0; r < rows; ++r)
    for (int d = 0; d < around; ++d) {
      const ShellPoint at = on_cup(cup, a, top * (r + 0.5) / rows, 2 * pi * d / around);
      outside += !is_inside(grid, at.position + half_wall_mm * at.normal);
    }
  return 1.0 * outside / (rows * around);
}

std::vector<RidgePoint> find_ridge(const Image& image, const LvShell& cup, int rows, int around, double reach_mm) {
  constexpr double step_mm = 1;
  constexpr int most_steps = 0.95 * most_radius_mm / step_mm;
  const int steps = std::min(most_steps, floor_int(std::min(reach_mm, 0.95 * cup.radius_mm) / step_mm));
  const image::LinearSampler value(image);
  const ShellBasis a = across(cup.axis);
  const double top = base_angle(cup);
  std::vector<RidgePoint> ridge;
  std::vector<double> profile(2 * steps + 1);
  const auto look = [&](double theta, double phi) {
    const ShellPoint at = on_cup(cup, outwards(a, turn_by(phi)), row_at(theta));
    image::SampledPoints<2 * most_steps + 1> places;
    for (int s = -steps; s <= steps; ++s) places.add(at.position + s * step_mm * at.normal);
    value(places, profile.data());
    int best = -1;
    double worth = 0;
    for (int s = 1; s < 2 * steps; ++s) {
      if (!(profile[s] >= profile[s - 1] && profile[s] > profile[s + 1])) continue;
      const double away = (s - steps) * step_mm / reach_mm;
      const double near = profile[s] * own::exp(-away * away);
      if (best < 0 || near > worth) best = s, worth = near;
    }
    RidgePoint point{at.position, profile[steps], 0, 0};
    if (best > 0) {
      const double bend = profile[best - 1] - 2 * profile[best] + profile[best + 1];
      const double shift = bend < 0 ? 0.5 * (profile[best - 1] - profile[best + 1]) / bend : 0;
      point.offset_mm = (best - steps + std::clamp(shift, -0.5, 0.5)) * step_mm;
      point.position = at.position + point.offset_mm * at.normal;
      point.brightness = profile[best];
      const auto low = [&](std::size_t from, std::size_t to) {
        return *std::min_element(profile.begin() + from, profile.begin() + to + 1);
      };
      // Beyond its edge a volume repeats its last voxels; what is seen there is no wall.
      if (is_inside(image.grid, point.position))
        point.prominence = point.brightness - std::max(low(0, best), low(best, profile.size() - 1));
    }
    ridge.push_back(point);
  };
  look(0, 0);
  for (int r = 1; r <= rows; ++r)
    for (int d = 0; d < around; ++d) look(top * r / rows, 2 * pi * (d + 0.5 * (r % 2)) / around);
  return ridge;
}

std::optional<LvShell> fit_cup(const std::vector<RidgePoint>& ridge, const LvShell& start) {
  constexpr int rounds = 12;
  constexpr std::size_t least_points = 12;
  std::vector<const RidgePoint*> seen;
  double brightest = 0;
  for (const RidgePoint& p : ridge)
    if (p.prominence > 0) seen.push_back(&p), brightest = std::max(brightest, p.prominence);
  if (seen.size() < least_points) return std::nullopt;

  LvShell cup = start;
  for (int round = 0; round < rounds; ++round) {
    const double cut = std::max(5.0, 14.0 - 2.0 * round);
    Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Zero();
    Eigen::Matrix<double, 7, 1> right = Eigen::Matrix<double, 7, 1>::Zero();
    // The elongation is held near that of the usual heart: a wide open base alone would not tell.
    const double pull = 0.01 * seen.size();
    const auto small = [](int n) { return n == 3 || n == 4 ? 1e-4 : 1e-3; };
    std::array<LvShell, 7> beside;
    for (int n = 0; n < 7; ++n) {
      Eigen::Matrix<double, 7, 1> by = Eigen::Matrix<double, 7, 1>::Zero();
      by[n] = small(n);
      beside[n] = moved(cup, by);
    }
    for (const RidgePoint* p : seen) {
      const double distance = signed_distance(cup, p->position);
      const double x = distance / cut;
      if (std::abs(x) >= 1) continue;
      const double w = (1 - x * x) * (1 - x * x) * std::min(1.0, p->prominence / (0.4 * brightest));
      Eigen::Matrix<double, 7, 1> slope;
      for (int n = 0; n < 7; ++n) slope[n] = (signed_distance(beside[n], p->position) - distance) / small(n);
      normal += w * slope * slope.transpose();
      right -= w * distance * slope;
    }
    const double stretched = cup.half_length_mm - usual_elongation * cup.radius_mm;
    normal(6, 6) += pull, right[6] -= pull * stretched;
    normal.diagonal().array() += 1e-6 * (1 + normal.trace());
    const Eigen::Matrix<double, 7, 1> by = normal.ldlt().solve(right);
    if (!by.allFinite()) return std::nullopt;
    Eigen::Matrix<double, 7, 1> limited = by;
    limited.head<3>() *= std::min(1.0, 5 / std::max(1e-9, by.head<3>().norm()));
    limited.segment<2>(3) *= std::min(1.0, 0.15 / std::max(1e-9, by.segment<2>(3).norm()));
    limited.tail<2>() = by.tail<2>().cwiseMax(-4).cwiseMin(4);
    const Vec3 base = cup.base();
    cup = moved(cup, limited);
    cup.radius_mm = std::clamp(cup.radius_mm, least_radius_mm, most_radius_mm);
    cup.half_length_mm =
        std::clamp(cup.half_length_mm, least_elongation * cup.radius_mm, most_elongation * cup.radius_mm);
    cup.base_mm = std::clamp((base - cup.centre).dot(cup.axis), 0.1 * cup.half_length_mm, 0.9 * cup.half_length_mm);
  }
  return cup;
}

}  // namespace dynasurf::heart
