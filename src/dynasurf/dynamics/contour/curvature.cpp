#include "dynasurf/dynamics/contour/detail/curvature.hpp"

#include <array>
#include <optional>

namespace dynasurf::dynamics {
namespace {

constexpr std::array<std::string_view, 2> filter_names{"fixed", "adaptive"};

Vec2 quarter_turn(const Vec2& t) { return {t.y(), -t.x()}; }

/// Direction of each edge; an edge without length continues the one before it, so that repeated points play no part.
std::vector<Vec2> directions(const Contour& c) {
  std::vector<Vec2> d(c.edges(), Vec2::Zero());
  std::optional<std::size_t> real;
  for (std::size_t e = 0; e < d.size(); ++e) {
    const Vec2 step = c.end_of_edge(e) - c.points[e];
    if (const double length = step.norm(); length > 0) {
      d[e] = step / length;
      if (!real) real = e;
    } else if (real) {
      d[e] = d[e - 1];
    }
  }
  if (real)
    for (std::size_t e = 0; e < *real; ++e) d[e] = c.closed ? d.back() : d[*real];
  return d;
}

struct Neighbours {
  std::size_t n;
  bool closed;
  std::optional<std::size_t> before(std::size_t i) const {
    if (i > 0) return i - 1;
    return closed ? std::optional(n - 1) : std::nullopt;
  }
  std::optional<std::size_t> after(std::size_t i) const {
    if (i + 1 < n) return i + 1;
    return closed ? std::optional<std::size_t>(0) : std::nullopt;
  }
};

/// Mean curvature per length of the points within `reach` along one side of point i.
void gather(const Contour& c, const std::vector<double>& per_length, std::size_t i, double reach, bool forwards,
            double& sum, int& count) {
  const Neighbours next{c.size(), c.closed};
  std::size_t at = i;
  double way = 0;
  for (bool first = true;; first = false) {
    const auto to = forwards ? next.after(at) : next.before(at);
    if (!to || *to == i) return;
    way += (c.points[*to] - c.points[at]).norm();
    if (!first && way > reach) return;  // the nearest neighbour always counts
    at = *to;
    sum += per_length[at];
    ++count;
  }
}

std::vector<double> adaptive_filter(const Contour& c, const std::vector<double>& k) {
  const std::size_t n = c.size();
  const double mean_edge = length_of(c) / c.edges();
  std::vector<double> own(n, 0.0), per_length(n, 0.0), s(n, 0.0);
  for (std::size_t e = 0; e < c.edges(); ++e) {
    const double half = (c.end_of_edge(e) - c.points[e]).norm() / 2;
    own[e] += half;
    own[e + 1 == n ? 0 : e + 1] += half;
  }
  for (std::size_t i = 0; i < n; ++i) per_length[i] = own[i] > 0 ? k[i] / own[i] : 0;
  for (std::size_t i = 0; i < n; ++i) {
    double ahead = 0, behind = 0;
    int ahead_count = 0, behind_count = 0;
    gather(c, per_length, i, 1.5 * mean_edge, true, ahead, ahead_count);
    gather(c, per_length, i, 1.5 * mean_edge, false, behind, behind_count);
    if (ahead_count == 0 || behind_count == 0) continue;
    s[i] = own[i] * (per_length[i] - (ahead / ahead_count + behind / behind_count) / 2);
  }
  return s;
}

}  // namespace

std::span<const std::string_view> names_of(CurvatureFilter) { return filter_names; }

CurvatureFrame curvature_frame(const Contour& c) {
  const std::size_t n = c.size();
  CurvatureFrame frame{std::vector<Vec2>(n, Vec2::Zero()), std::vector<double>(n, 0.0)};
  if (n < 2) return frame;
  const std::vector<Vec2> d = directions(c);
  for (std::size_t i = 0; i < n; ++i) {
    const bool end = !c.closed && (i == 0 || i + 1 == n);
    const Vec2& out = d[!c.closed && i + 1 == n ? n - 2 : i];
    const Vec2& in = end ? out : d[i == 0 ? n - 1 : i - 1];
    const Vec2 sum = in + out;
    const double length = sum.norm();
    // Twice the cosine of half the turn: below this it has no direction worth the name.
    if (length > 1e-9)
      frame.radial[i] = quarter_turn(sum / length);
    else
      frame.radial[i] = i > 0 ? frame.radial[i - 1] : quarter_turn(out);
    if (!end) frame.k[i] = (out - in).dot(frame.radial[i]);
  }
  return frame;
}

std::vector<Vec2> curvature_force(const Contour& c, const CurvatureFrame& frame, CurvatureFilter filter) {
  const std::size_t n = c.size();
  std::vector<Vec2> force(n, Vec2::Zero());
  if (n < 3) return force;
  if (filter == CurvatureFilter::adaptive) {
    const std::vector<double> s = adaptive_filter(c, frame.k);
    for (std::size_t i = 0; i < n; ++i)
      if (c.closed || (i > 0 && i + 1 < n)) force[i] = s[i] * frame.radial[i];
    return force;
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!c.closed && (i == 0 || i + 1 == n)) continue;
    const double before = frame.k[i == 0 ? n - 1 : i - 1], after = frame.k[i + 1 == n ? 0 : i + 1];
    force[i] = (frame.k[i] - (before + after) / 2) * frame.radial[i];
  }
  return force;
}

}  // namespace dynasurf::dynamics
