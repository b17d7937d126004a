#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/dynamics/forces/detail/condition.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {
namespace {

using namespace conditions;

/// Two triangles at an edge: x1 and x2 lie opposite, the edge runs from x3 to x4 in the triangle of x1.
struct Hinge {
  std::array<std::uint32_t, 4> particles{};
  double low = 0, high = 0;  // angles at rest
};

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

struct Fold {
  Vec3 x1, x2, x3, x4, edge, n1, n2;  // normals of twice the triangles' area
  double length = 0;
  Fold(const std::array<std::uint32_t, 4>& p, std::span<const Vec3> x)
      : x1(x[p[0]]), x2(x[p[1]]), x3(x[p[2]]), x4(x[p[3]]), edge(x4 - x3) {
    n1 = (x1 - x3).cross(x1 - x4);
    n2 = (x2 - x4).cross(x2 - x3);
    length = edge.norm();
  }
  bool is_degenerate() const {
    const double scale = std::max({length, (x1 - x3).norm(), (x2 - x3).norm()});
    const double least = 1e-12 * scale * scale;
    return !(length > 1e-12 * scale && n1.norm() > least && n2.norm() > least);
  }
  double angle() const { return own::atan2(n1.cross(n2).dot(edge) / length, n1.dot(n2)); }
};

/// Derivatives of the angle: every one of the four is a sum of terms s * u with u1 = n1/|n1|^2 or u2 = n2/|n2|^2.
void differentiate(const Fold& f, Condition<4>& c, bool with_hessian) {
  const Vec3 e = f.edge / f.length, u1 = f.n1 / f.n1.squaredNorm(), u2 = f.n2 / f.n2.squaredNorm();
  const std::array<double, 4> s1{-f.length, 0, -(f.x1 - f.x4).dot(e), (f.x1 - f.x3).dot(e)};
  const std::array<double, 4> s2{0, -f.length, -(f.x2 - f.x4).dot(e), (f.x2 - f.x3).dot(e)};
  for (std::size_t i = 0; i < 4; ++i) c.gradient[i] = s1[i] * u1 + s2[i] * u2;
  if (!with_hessian) return;

  const Mat3 zero = Mat3::Zero();
  const auto slope_of_u = [](const Vec3& n) -> Mat3 {
    const double squared = n.squaredNorm();
    return (Mat3::Identity() - 2 / squared * n * n.transpose()) / squared;
  };
  const Mat3 du1 = slope_of_u(f.n1), du2 = slope_of_u(f.n2);
  const std::array<Mat3, 4> dn1{cross_matrix(f.edge), zero, cross_matrix(f.x1 - f.x4), -cross_matrix(f.x1 - f.x3)};
  const std::array<Mat3, 4> dn2{zero, -cross_matrix(f.edge), -cross_matrix(f.x2 - f.x4), cross_matrix(f.x2 - f.x3)};
  // Slopes of the factors s; `turn` is what a projection on e gains when the edge turns.
  const auto turn = [&](const Vec3& v) -> Vec3 { return (v - e.dot(v) * e) / f.length; };
  const Vec3 none = Vec3::Zero();
  const auto slopes = [&](const Vec3& x, std::size_t own) {
    std::array<std::array<Vec3, 4>, 4> ds;
    for (auto& row : ds) row.fill(none);
    ds[own][2] = e;
    ds[own][3] = -e;
    ds[2][own] = -e;
    ds[2][2] = turn(x - f.x4);
    ds[2][3] = e - turn(x - f.x4);
    ds[3][own] = e;
    ds[3][2] = -e - turn(x - f.x3);
    ds[3][3] = turn(x - f.x3);
    return ds;
  };
  const auto ds1 = slopes(f.x1, 0), ds2 = slopes(f.x2, 1);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      c.hessian[i][j] =
          u1 * ds1[i][j].transpose() + s1[i] * du1 * dn1[j] + u2 * ds2[i][j].transpose() + s2[i] * du2 * dn2[j];
}

/// How far an angle is from the interval at rest, the short way round.
double excess(double angle, const Hinge& h) {
  const double middle = (h.low + h.high) / 2, half = (h.high - h.low) / 2;
  const double from_middle = std::remainder(angle - middle, 2 * std::numbers::pi);
  return from_middle > half ? from_middle - half : from_middle < -half ? from_middle + half : 0.0;
}

std::vector<Hinge> hinges_of(const TriMesh& rest, const BendForce& o) {
  // Directed edge -> opposite vertices; an edge between two oriented triangles occurs once each way.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> opposite;
  for (const auto& t : rest.triangles)
    for (std::size_t k = 0; k < 3; ++k) opposite[{t[(k + 1) % 3], t[(k + 2) % 3]}].push_back(t[k]);
  std::vector<Hinge> hinges;
  for (const auto& [edge, here] : opposite) {
    if (edge.first > edge.second || here.size() != 1) continue;
    const auto there = opposite.find({edge.second, edge.first});
    if (there == opposite.end() || there->second.size() != 1) continue;
    Hinge hinge{{here[0], there->second[0], edge.first, edge.second}};
    if (o.rest == BendRest::zone) {
      hinge.low = o.zone_low_rad;
      hinge.high = o.zone_high_rad;
    } else if (o.rest == BendRest::initial) {
      const Fold fold(hinge.particles, rest.vertices);
      if (!fold.is_degenerate()) hinge.low = hinge.high = fold.angle();
    }
    hinges.push_back(hinge);
  }
  return hinges;
}

}  // namespace

Force bend_force(const TriMesh& rest, const BendForce& o) {
  return make_force("bend", hinges_of(rest, o), {o.stiffness, o.damping},
                    [](const Hinge& h, const ParticleState& state, Want want, auto use) {
                      const Fold fold(h.particles, state.positions);
                      if (fold.is_degenerate()) return;
                      Condition<4> c{h.particles, excess(fold.angle(), h)};
                      if (c.value == 0 && h.low < h.high) return;  // free inside its zone, undamped, too
                      differentiate(fold, c, want == Want::hessian);
                      use(c);
                    });
}

}  // namespace dynasurf::dynamics
