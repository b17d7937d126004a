#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <Eigen/LU>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/contours.hpp"

namespace dynasurf::dynamics {
namespace {

/// The symmetric pentadiagonal band without corners, factored as L D L'.
class Band {
 public:
  Band(std::size_t n, double main, double next, double second) : d_(n), l1_(n, 0.0), l2_(n, 0.0) {
    for (std::size_t i = 0; i < n; ++i) {
      const double far = i > 1 ? second : 0, near = i > 0 ? next : 0;
      l2_[i] = i > 1 ? far / d_[i - 2] : 0;
      l1_[i] = i > 0 ? (near - (i > 1 ? l2_[i] * d_[i - 2] * l1_[i - 1] : 0)) / d_[i - 1] : 0;
      d_[i] = main - (i > 0 ? l1_[i] * l1_[i] * d_[i - 1] : 0) - (i > 1 ? l2_[i] * l2_[i] * d_[i - 2] : 0);
    }
  }

  template <class T>
  void solve(std::vector<T>& x) const {
    const std::size_t n = d_.size();
    for (std::size_t i = 1; i < n; ++i) {
      x[i] -= l1_[i] * x[i - 1];
      if (i > 1) x[i] -= l2_[i] * x[i - 2];
    }
    for (std::size_t i = 0; i < n; ++i) x[i] /= d_[i];
    for (std::size_t i = n; i > 0;) {
      --i;
      if (i + 1 < n) x[i] -= l1_[i + 1] * x[i + 1];
      if (i + 2 < n) x[i] -= l2_[i + 2] * x[i + 2];
    }
  }

 private:
  std::vector<double> d_, l1_, l2_;
};

void respace(Contour& c, double edge) {
  const double length = length_of(c);
  const int count = std::max(8, round_int(length / edge));
  if (length > 1e-6) c = spread_evenly(c, count, centroid_of(c));
}

}  // namespace

std::vector<Vec2> solve_cyclic_pentadiagonal(double main, double next, double second, const std::vector<Vec2>& b) {
  const std::size_t n = b.size();
  if (n < 5) throw InputError("a ring of " + std::to_string(n) + " unknowns; expected 5 or more");
  // The last two unknowns are set apart: the others are a plain band, with those two on the right side.
  const std::size_t m = n - 2;
  const Band band(m, main, next, second);
  std::vector<Vec2> y(b.begin(), b.end() - 2);
  band.solve(y);
  std::array<std::vector<double>, 2> coupling{std::vector<double>(m, 0.0), std::vector<double>(m, 0.0)};
  coupling[0][m - 1] += next, coupling[0][m - 2] += second, coupling[0][0] += second;  // unknown n-2
  coupling[1][m - 1] += second, coupling[1][0] += next, coupling[1][1] += second;      // unknown n-1
  std::array<std::vector<double>, 2> z = coupling;
  for (auto& column : z) band.solve(column);

  Eigen::Matrix2d schur;
  schur << main, next, next, main;
  Eigen::Matrix2d right;
  right.row(0) = b[n - 2].transpose();
  right.row(1) = b[n - 1].transpose();
  for (int r = 0; r < 2; ++r)
    for (std::size_t i = 0; i < m; ++i) {
      const double c = coupling[r][i];
      if (c == 0) continue;
      for (int s = 0; s < 2; ++s) schur(r, s) -= c * z[s][i];
      right.row(r) -= c * y[i].transpose();
    }
  const Eigen::Matrix2d last = schur.inverse() * right;
  for (std::size_t i = 0; i < m; ++i) y[i] -= z[0][i] * last.row(0).transpose() + z[1][i] * last.row(1).transpose();
  y.push_back(last.row(0).transpose());
  y.push_back(last.row(1).transpose());
  return y;
}

ContourResult evolve_snake(const Contour& start, const field::VectorField& field, const Snake& requested) {
  Snake o = requested;
  check_options(o, "snake");
  const bool finite =
      std::all_of(start.points.begin(), start.points.end(), [](const Vec2& p) { return p.allFinite(); });
  if (!start.closed || start.size() < 5 || !finite)
    throw InputError("evolve_snake: a contour of " + std::to_string(start.size()) +
                     " points; expected a closed one of 5 or more, all finite");
  const double main = 1 + o.step * (2 * o.alpha + 6 * o.beta);
  const double next = -o.step * (o.alpha + 4 * o.beta), second = o.step * o.beta;
  ContourResult r;
  r.contour = start;
  for (r.steps = 0; r.steps < o.max_steps;) {
    if (o.respace_every > 0 && r.steps % o.respace_every == 0) respace(r.contour, o.edge_px);
    std::vector<Vec2> right = r.contour.points;
    if (!field.x.empty())
      for (Vec2& p : right) p += o.step * o.external * force_at(field, p);
    std::vector<Vec2> moved = solve_cyclic_pentadiagonal(main, next, second, right);
    double farthest = 0;
    for (std::size_t i = 0; i < moved.size(); ++i)
      farthest = std::max(farthest, (moved[i] - r.contour.points[i]).norm());
    ++r.steps;
    if (!std::isfinite(farthest)) {
      r.reason = StopReason::diverged;
      return r;
    }
    r.contour.points = std::move(moved);
    if (farthest < o.still_px) {
      r.reason = StopReason::at_rest;
      break;
    }
  }
  return r;
}

}  // namespace dynasurf::dynamics
