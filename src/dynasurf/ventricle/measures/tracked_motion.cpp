#include "dynasurf/ventricle/measures/tracked_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/point_spline.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr std::size_t least_points = 12, least_in_level = 3;
constexpr double nearest_mm = 2;  // to the axis, where round it and away from it mean nothing

/// The long axis as directions, and where each point lies along it at rest.
struct Frame {
  Vec3 apex, up;  // `up`: unit, to the base
  double length_mm = 0, length_sd_mm = 0;
  std::array<std::vector<std::size_t>, 3> in_level;
  std::vector<double> height_mm;
};

Frame frame_of(const std::vector<Vec3>& rest, const LongAxis& axis) {
  Frame f;
  f.apex = axis.apex;
  f.length_mm = (axis.base - axis.apex).norm(), f.length_sd_mm = axis.length_sd_mm;
  if (!(f.length_mm > 1) || !std::isfinite(f.length_mm))
    throw InputError("the long axis from apex to base is " + std::to_string(f.length_mm) +
                     " mm long; expected more than 1");
  f.up = (axis.base - axis.apex) / f.length_mm;
  for (std::size_t n = 0; n < rest.size(); ++n) {
    f.height_mm.push_back((rest[n] - f.apex).dot(f.up));
    const int third = floor_int(3 * f.height_mm[n] / f.length_mm);
    f.in_level[std::clamp(third, 0, 2)].push_back(n);
  }
  return f;
}

/// What the points of a level did across the axis.
struct Turn {
  std::vector<double> angle;   // per point of the level, rad
  std::vector<double> weight;  // square of its distance from the middle, mm^2
  double rotation = 0;         // of all together, rad
};

Turn turn_of(const Frame& f, const std::vector<std::size_t>& level, const std::vector<Vec3>& rest,
             const std::vector<Vec3>& now) {
  const auto across = [&](const Vec3& p) -> Vec3 { return p - p.dot(f.up) * f.up; };
  const double count = level.size();
  Vec3 before = Vec3::Zero(), after = Vec3::Zero();
  for (const std::size_t n : level) {
    before += across(rest[n]) / count;
    after += across(now[n]) / count;
  }
  Turn turn;
  double sine = 0, cosine = 0;
  for (const std::size_t n : level) {
    const Vec3 a = across(rest[n]) - before, b = across(now[n]) - after;
    const double s = -f.up.dot(a.cross(b)), c = a.dot(b);  // seen from the apex
    turn.angle.push_back(own::atan2(s, c));
    turn.weight.push_back(a.squaredNorm());
    sine += s, cosine += c;
  }
  turn.rotation = own::atan2(sine, cosine);
  return turn;
}

/// The line of the rotation over the height, by least squares.
struct Line {
  double slope = 0, slope_sd = 0;  // rad/mm
};

Line line_of(const std::vector<double>& height, const std::vector<double>& angle, const std::vector<double>& weight) {
  double sum = 0, h = 0, a = 0;
  for (std::size_t n = 0; n < height.size(); ++n)
    sum += weight[n], h += weight[n] * height[n], a += weight[n] * angle[n];
  if (!(sum > 0)) return {};
  h /= sum, a /= sum;
  double hh = 0, ha = 0, left = 0;
  for (std::size_t n = 0; n < height.size(); ++n) {
    hh += weight[n] * (height[n] - h) * (height[n] - h);
    ha += weight[n] * (height[n] - h) * (angle[n] - a);
  }
  if (!(hh > 0)) return {};
  Line line{ha / hh, 0};
  for (std::size_t n = 0; n < height.size(); ++n) {
    const double residual = angle[n] - a - line.slope * (height[n] - h);
    left += weight[n] * residual * residual;
  }
  // Of the points' places, mm^2: a slip across the radius turns by slip over radius.
  const double variance = left / std::max<std::size_t>(1, height.size() - 2);
  line.slope_sd = std::sqrt(variance / hh);
  return line;
}

std::optional<Strains> strains_at(const Frame& f, const Vec3& p, const mesh::SplineMotion& motion) {
  const Vec3 from = p - f.apex;
  const Vec3 out = from - from.dot(f.up) * f.up;
  if (out.norm() < nearest_mm) return std::nullopt;
  const Vec3 radial = out.normalized();
  const Mat3 gradient = motion.gradient(p);
  const auto strain = [&](const Vec3& along) { return 100 * ((gradient * along).norm() - 1); };
  return Strains{strain(radial), strain(f.up.cross(radial)), strain(f.up)};
}

Strains mean_of(const std::vector<std::optional<Strains>>& strains, const std::vector<std::size_t>& chosen) {
  Strains mean;
  int count = 0;
  for (const std::size_t n : chosen) {
    if (!strains[n]) continue;
    mean.radial_percent += strains[n]->radial_percent;
    mean.circumferential_percent += strains[n]->circumferential_percent;
    mean.longitudinal_percent += strains[n]->longitudinal_percent;
    ++count;
  }
  const double share = 1.0 / std::max(1, count);
  return {share * mean.radial_percent, share * mean.circumferential_percent, share * mean.longitudinal_percent};
}

GateMotion measure_gate(const Frame& f, const std::vector<Vec3>& rest, const std::vector<Vec3>& now,
                        const mesh::SplineMotion& motion) {
  std::vector<std::optional<Strains>> strains;
  std::vector<std::size_t> all;
  for (std::size_t n = 0; n < rest.size(); ++n) strains.push_back(strains_at(f, rest[n], motion)), all.push_back(n);
  GateMotion gate;
  gate.strains = mean_of(strains, all);
  std::vector<double> height, angle, weight;
  for (std::size_t level = 0; level < 3; ++level) {
    const std::vector<std::size_t>& members = f.in_level[level];
    if (members.size() < least_in_level) continue;
    const Turn turn = turn_of(f, members, rest, now);
    LevelMotion& of = gate.levels[level].emplace();
    of.points = members.size();
    of.rotation_deg = turn.rotation / degrees;
    of.strains = mean_of(strains, members);
    double sum = 0;
    for (std::size_t m = 0; m < members.size(); ++m) {
      of.height_mm += turn.weight[m] * f.height_mm[members[m]];
      sum += turn.weight[m];
      height.push_back(f.height_mm[members[m]]);
    }
    of.height_mm /= std::max(sum, 1e-12);
    angle.insert(angle.end(), turn.angle.begin(), turn.angle.end());
    weight.insert(weight.end(), turn.weight.begin(), turn.weight.end());
  }
  const Line line = line_of(height, angle, weight);
  gate.twist_deg = (0 - line.slope) * f.length_mm / degrees;  // the apex against the base; no -0
  gate.twist_sd_deg = own::hypot(line.slope_sd * f.length_mm, line.slope * f.length_sd_mm) / degrees;
  gate.torsion_deg_per_cm = 10 * (0 - line.slope) / degrees;
  return gate;
}

/// The median distance of a point from its nearest neighbour.
double spacing_of(const std::vector<Vec3>& points) {
  std::vector<double> nearest(points.size(), std::numeric_limits<double>::infinity());
  for (std::size_t a = 0; a < points.size(); ++a)
    for (std::size_t b = 0; b < points.size(); ++b)
      if (a != b) nearest[a] = std::min(nearest[a], (points[a] - points[b]).norm());
  return upper_median(std::move(nearest));
}

}  // namespace

TrackedMotion measure_motion(const TrackedPoints& points, const LongAxis& axis, int rest_gate) {
  if (rest_gate < 0 || rest_gate >= std::ssize(points.gates))
    throw OptionError("gate " + std::to_string(rest_gate + 1) + " at rest; expected 1 to " +
                      std::to_string(points.gates.size()));
  const std::vector<Vec3>& rest = points.gates[rest_gate];
  if (rest.size() < least_points)
    throw InputError(std::to_string(rest.size()) + " tracked points that are known in every gate; expected at least " +
                     std::to_string(least_points));
  const mesh::PointSpline spline(rest);
  const Frame frame = frame_of(rest, axis);
  if (std::count_if(frame.in_level.begin(), frame.in_level.end(),
                    [](const auto& level) { return level.size() >= least_in_level; }) < 2)
    throw InputError("the tracked points lie in one third of the long axis; expected 3 or more in two thirds");
  TrackedMotion result;
  result.rest_gate = rest_gate;
  result.length_mm = frame.length_mm;
  result.gates.resize(points.gates.size());
  parallel_for(points.gates.size(), 1, [&](std::size_t g, std::size_t) {
    result.gates[g] = measure_gate(frame, rest, points.gates[g], spline.motion_to(points.gates[g]));
  });
  result.spacing_mm = spacing_of(rest);
  for (std::size_t g = 0; g < result.gates.size(); ++g)
    if (std::abs(result.gates[g].twist_deg) > std::abs(result.gates[result.peak_gate].twist_deg)) result.peak_gate = g;
  return result;
}

}  // namespace dynasurf::ventricle
