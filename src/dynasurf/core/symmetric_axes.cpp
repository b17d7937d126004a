#include "dynasurf/core/detail/symmetric_axes.hpp"

#include <cmath>
#include <utility>

namespace dynasurf {
namespace {

/// Turns axes p and q so that m(p, q) becomes 0.
void rotate(Mat3& m, Mat3& directions, int p, int q) {
  const double off = m(p, q);
  if (off == 0) return;
  const double half_difference = 0.5 * (m(q, q) - m(p, p));
  // The smaller of both tangents: no axis turns by more than 45 degrees.
  const double length = std::sqrt(half_difference * half_difference + off * off);
  const double t = half_difference < 0 ? -off / (length - half_difference) : off / (length + half_difference);
  const double c = 1 / std::sqrt(1 + t * t), s = c * t;
  const int r = 3 - p - q;
  const double to_p = m(r, p), to_q = m(r, q);
  m(p, p) -= t * off;
  m(q, q) += t * off;
  m(p, q) = m(q, p) = 0;
  m(r, p) = m(p, r) = c * to_p - s * to_q;
  m(r, q) = m(q, r) = s * to_p + c * to_q;
  for (int i = 0; i < 3; ++i) {
    const double a = directions(i, p), b = directions(i, q);
    directions(i, p) = c * a - s * b;
    directions(i, q) = s * a + c * b;
  }
}

}  // namespace

SymmetricAxes symmetric_axes(const Mat3& matrix) {
  SymmetricAxes axes;
  const double size = matrix.cwiseAbs().maxCoeff();
  if (!matrix.allFinite()) {
    axes.values.setConstant(NAN);
    axes.directions.setConstant(NAN);
    return axes;
  }
  if (size == 0) return axes;
  Mat3 m = matrix / size;  // squares of entries stay within the range of numbers
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < a; ++b) m(a, b) = m(b, a);
  // Convergence is quadratic: 5 rounds are the most that was ever seen to be needed.
  for (int round = 0; round < 12; ++round) {
    const double off = m(0, 1) * m(0, 1) + m(0, 2) * m(0, 2) + m(1, 2) * m(1, 2);
    if (off < 1e-34) break;
    rotate(m, axes.directions, 0, 1);
    rotate(m, axes.directions, 0, 2);
    rotate(m, axes.directions, 1, 2);
  }
  axes.values = size * m.diagonal();
  const auto in_order = [&](int a, int b) {
    if (axes.values[a] <= axes.values[b]) return;
    std::swap(axes.values[a], axes.values[b]);
    axes.directions.col(a).swap(axes.directions.col(b));
    axes.directions.col(a) = -axes.directions.col(a);  // still a rotation
  };
  in_order(0, 1);
  in_order(1, 2);
  in_order(0, 1);
  return axes;
}

}  // namespace dynasurf
