#include <algorithm>
#include <cmath>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/contours.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr double shortest = 0.5, longest = 1.5;  // of the wanted edge; a half of `longest` is above `shortest`

bool all_finite(const Contour& c) {
  return std::all_of(c.points.begin(), c.points.end(), [](const Vec2& p) { return p.allFinite(); });
}

double edge_length(const Contour& c, std::size_t e) { return (c.end_of_edge(e) - c.points[e]).norm(); }

bool merge_short_edges(Contour& c, std::vector<Vec2>& carried, double limit) {
  bool changed = false;
  for (std::size_t e = 0; e < c.edges() && c.size() > 3;) {
    if (edge_length(c, e) >= limit) {
      ++e;
      continue;
    }
    const std::size_t next = e + 1 == c.size() ? 0 : e + 1;
    // The ends of an open contour stay where they are.
    const bool keep_first = !c.closed && e == 0, keep_last = !c.closed && next + 1 == c.size();
    const Vec2 place = keep_first ? c.points[e] : keep_last ? c.points[next] : Vec2((c.points[e] + c.points[next]) / 2);
    if (!carried.empty()) carried[e] = (carried[e] + carried[next]) / 2;
    c.points[e] = place;
    c.points.erase(c.points.begin() + next);
    if (!carried.empty()) carried.erase(carried.begin() + next);
    changed = true;
    ++e;                   // a merged point rests for this round: else a run of short edges would shrink to its end
    if (next == 0) break;  // the last edge is gone, and the first point with it
  }
  return changed;
}

bool split_long_edges(Contour& c, std::vector<Vec2>& carried, double limit) {
  Contour fine{{}, c.closed};
  std::vector<Vec2> fine_carried;
  for (std::size_t i = 0; i < c.size(); ++i) {
    fine.points.push_back(c.points[i]);
    if (!carried.empty()) fine_carried.push_back(carried[i]);
    if (i >= c.edges() || edge_length(c, i) <= limit) continue;
    const std::size_t next = i + 1 == c.size() ? 0 : i + 1;
    fine.points.push_back((c.points[i] + c.points[next]) / 2);
    if (!carried.empty()) fine_carried.push_back((carried[i] + carried[next]) / 2);
  }
  const bool changed = fine.size() != c.size();
  c = std::move(fine);
  carried = std::move(fine_carried);
  return changed;
}

std::vector<Vec2> forces(const Contour& c, const field::VectorField& field, const DiscreteContour& o) {
  const CurvatureFrame frame = curvature_frame(c);
  std::vector<Vec2> f = curvature_force(c, frame, o.filter);
  for (std::size_t i = 0; i < f.size(); ++i) {
    f[i] *= o.internal;
    if (field.x.empty()) continue;
    const Vec2 pull = force_at(field, c.points[i]);
    f[i] += o.external * (o.radial_only ? Vec2(pull.dot(frame.radial[i]) * frame.radial[i]) : pull);
  }
  return f;
}

}  // namespace

void resample(Contour& contour, double edge_px, std::vector<Vec2>& carried) {
  if (!(edge_px > 0))
    throw OptionError("resample: edge_px is " + std::to_string(edge_px) + "; expected a positive one");
  for (int round = 0; round < 10; ++round) {
    const bool merged = merge_short_edges(contour, carried, shortest * edge_px);
    if (!split_long_edges(contour, carried, longest * edge_px) && !merged) return;
  }
}

void resample(Contour& contour, double edge_px) {
  std::vector<Vec2> none;
  resample(contour, edge_px, none);
}

ContourResult evolve_contour(const Contour& start, const field::VectorField& field, const DiscreteContour& requested) {
  DiscreteContour o = requested;
  check_options(o, "contour");
  if (start.size() < 3 || !all_finite(start))
    throw InputError("evolve_contour: a contour of " + std::to_string(start.size()) +
                     " points; expected 3 or more, all finite");
  ContourResult r;
  r.contour = start;
  std::vector<Vec2> velocity(start.size(), Vec2::Zero());
  int still = 0;
  // The curvature force knows no size. It throws a contour that has shrunk to nothing to and fro, and the splitting of
  // its edges would go on for ever.
  const double least = 3 * shortest * o.edge_px;
  const double most = 10 * std::max(length_of(start), 2.0 * (field.grid.dims[0] + field.grid.dims[1]));
  for (r.steps = 0; r.steps < o.max_steps;) {
    if (o.resample_every > 0 && r.steps % o.resample_every == 0) resample(r.contour, o.edge_px, velocity);
    const std::vector<Vec2> pull = forces(r.contour, field, o);
    Contour moved = r.contour;
    double fastest = 0, hardest = 0;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const Vec2 acceleration = (pull[i] - o.damping * velocity[i]) / o.mass;
      velocity[i] += o.step * acceleration;
      moved.points[i] += o.step * velocity[i];
      fastest = std::max(fastest, velocity[i].norm());
      hardest = std::max(hardest, acceleration.norm());
    }
    ++r.steps;
    const double length = length_of(moved);
    const bool collapsed = o.resample_every > 0 && length < least;
    if (!all_finite(moved) || !(length < most) || collapsed) {
      r.reason = StopReason::diverged;
      return r;
    }
    r.contour = std::move(moved);
    still = fastest < o.still_px && hardest < o.still_px ? still + 1 : 0;
    if (still >= o.still_checks) {
      r.reason = StopReason::at_rest;
      break;
    }
  }
  if (o.resample_every > 0) resample(r.contour, o.edge_px, velocity);
  return r;
}

}  // namespace dynasurf::dynamics
