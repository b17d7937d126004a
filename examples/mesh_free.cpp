// Linear elasticity without a mesh (thesis 6.1.6.2 names it beside finite elements): the displacement between scattered
// points is read by moving least squares (element-free Galerkin, Belytschko, Lu and Gu 1994), the energy summed over
// the cells of a background grid that knows nothing of the points. A bar is pulled, which has an exact answer, and
// bent, where tetrahedra are the judge. usage: example_mesh_free
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "dynasurf/mesh/tetrahedra.hpp"

namespace {

using namespace dynasurf;

constexpr double kLength = 60, kSide = 12, kSpacing = 4;  // mm
constexpr mesh::Elasticity kMaterial{1, 0.3};

/// The shares of the points around a place in what is read there, and their slopes.
struct Reading {
  std::vector<int> points;
  std::vector<double> share;
  std::vector<Vec3> slope;
};

class PointCloudField {
 public:
  explicit PointCloudField(std::vector<Vec3> points, double reach) : points_(std::move(points)), reach_(reach) {}
  const std::vector<Vec3>& points() const { return points_; }

  /// phi_i(x) = p(x)' A(x)^-1 w_i p(x_i) with p = (1, y), y the way from x: a linear motion is read exactly.
  Reading at(const Vec3& x) const {
    Reading r;
    Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
    std::array<Eigen::Matrix4d, 3> da;
    da.fill(Eigen::Matrix4d::Zero());
    std::vector<Eigen::Vector4d> base;
    std::vector<double> weight;
    std::vector<Vec3> weight_slope;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
      const Vec3 way = points_[static_cast<std::size_t>(i)] - x;
      const double s = way.norm() / reach_;
      if (s >= 1) continue;
      // (1 - s)^4 (1 + 4 s), twice smooth at its end (Wendland).
      const double w = std::pow(1 - s, 4) * (1 + 4 * s);
      const Vec3 dw = 20 * std::pow(1 - s, 3) / (reach_ * reach_) * way;  // along x
      const Eigen::Vector4d p(1, points_[static_cast<std::size_t>(i)][0], points_[static_cast<std::size_t>(i)][1],
                              points_[static_cast<std::size_t>(i)][2]);
      a += w * p * p.transpose();
      for (std::size_t k = 0; k < 3; ++k) da[k] += dw[static_cast<Eigen::Index>(k)] * p * p.transpose();
      r.points.push_back(i), base.push_back(p), weight.push_back(w), weight_slope.push_back(dw);
    }
    const Eigen::Matrix4d inverse = a.inverse();
    const Eigen::Vector4d here(1, x[0], x[1], x[2]), solved = inverse * here;
    std::array<Eigen::Vector4d, 3> solved_slope;
    for (std::size_t k = 0; k < 3; ++k)
      solved_slope[k] = inverse * (Eigen::Vector4d::Unit(static_cast<int>(k) + 1) - da[k] * solved);
    for (std::size_t n = 0; n < r.points.size(); ++n) {
      r.share.push_back(weight[n] * solved.dot(base[n]));
      Vec3 slope;
      for (std::size_t k = 0; k < 3; ++k)
        slope[static_cast<Eigen::Index>(k)] = weight_slope[n][static_cast<Eigen::Index>(k)] * solved.dot(base[n]) +
                                              weight[n] * solved_slope[k].dot(base[n]);
      r.slope.push_back(slope);
    }
    return r;
  }

 private:
  std::vector<Vec3> points_;
  double reach_;
};

/// Points of the bar, each inner one a little off its place: no rows, no neighbours are known.
std::vector<Vec3> scattered() {
  std::vector<Vec3> points;
  unsigned state = 7;
  const auto off = [&](double x, double end) {
    state = state * 1664525u + 1013904223u;
    return x == 0 || x == end ? 0.0 : 0.6 * kSpacing * (static_cast<double>(state >> 8) / (1u << 24) - 0.5);
  };
  for (double x = 0; x <= kLength; x += kSpacing)
    for (double y = 0; y <= kSide; y += kSpacing)
      for (double z = 0; z <= kSide; z += kSpacing)
        points.emplace_back(x + off(x, kLength), y + off(y, kSide), z + off(z, kSide));
  return points;
}

/// Visits the Gauss points of a face or of the solid: two along each side of a cell.
void over_cells(const Vec3& from, const Vec3& to, int axes, const std::function<void(const Vec3&, double)>& visit) {
  constexpr double cell = 3, gauss = 0.57735026918962576;
  std::array<std::vector<double>, 3> at;
  double weight = 1;
  for (int a = 0; a < 3; ++a) {
    if (((axes >> a) & 1) == 0) {
      at[static_cast<std::size_t>(a)] = {from[a]};
      continue;
    }
    for (double low = from[a]; low < to[a] - 1e-9; low += cell)
      for (const double g : {-gauss, gauss}) at[static_cast<std::size_t>(a)].push_back(low + cell * (1 + g) / 2);
    weight *= cell / 2;
  }
  for (const double x : at[0])
    for (const double y : at[1])
      for (const double z : at[2]) visit({x, y, z}, weight);
}

/// What the bar does that is held at x = 0 and pulled at its other end by a stress, N/mm2.
std::function<Vec3(const Vec3&)> solve(const PointCloudField& field, const Vec3& stress) {
  const auto unknowns = static_cast<Eigen::Index>(3 * field.points().size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd load = Eigen::VectorXd::Zero(unknowns);
  const double nu = kMaterial.poisson, young = kMaterial.young_mpa;
  const double lambda = young * nu / ((1 + nu) * (1 - 2 * nu)), mu = young / (2 * (1 + nu));
  const auto add = [&](int i, int j, const Mat3& k) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        if (3 * i + r >= 3 * j + c) entries.emplace_back(3 * i + r, 3 * j + c, k(r, c));
  };
  over_cells({0, 0, 0}, {kLength, kSide, kSide}, 7, [&](const Vec3& x, double weight) {
    const Reading r = field.at(x);
    for (std::size_t i = 0; i < r.points.size(); ++i)
      for (std::size_t j = 0; j < r.points.size(); ++j) {
        const Vec3 &a = r.slope[i], &b = r.slope[j];
        add(r.points[i], r.points[j],
            weight * (lambda * a * b.transpose() + mu * b * a.transpose() + mu * a.dot(b) * Mat3::Identity()));
      }
  });
  over_cells({kLength, 0, 0}, {kLength, kSide, kSide}, 6, [&](const Vec3& x, double weight) {
    const Reading r = field.at(x);
    for (std::size_t i = 0; i < r.points.size(); ++i) load.segment<3>(3 * r.points[i]) += weight * r.share[i] * stress;
  });
  // Shares are not 1 at their own point, so what is held is held by stiff springs along the face: all of x, and of y
  // and z as much as keeps the bar from turning when it is pulled.
  const bool is_bent = stress[0] == 0;
  over_cells({0, 0, 0}, {0, kSide, kSide}, 6, [&](const Vec3& x, double weight) {
    const Reading r = field.at(x);
    const double across = is_bent ? 1 : 1e-6;
    for (std::size_t i = 0; i < r.points.size(); ++i)
      for (std::size_t j = 0; j < r.points.size(); ++j)
        add(r.points[i], r.points[j],
            weight * 1e4 * young * r.share[i] * r.share[j] * Vec3(1, across, across).asDiagonal().toDenseMatrix());
  });
  Eigen::SparseMatrix<double> stiffness(unknowns, unknowns);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(stiffness);
  const Eigen::VectorXd found = factor.solve(load);
  return [&field, found](const Vec3& x) {
    const Reading r = field.at(x);
    Vec3 moved = Vec3::Zero();
    for (std::size_t i = 0; i < r.points.size(); ++i) moved += r.share[i] * found.segment<3>(3 * r.points[i]);
    return moved;
  };
}

/// The same bar of tetrahedra of 2 mm, held at its end and bent by a force spread over the other: the way of its end.
double bend_of_tetrahedra(double stress) {
  constexpr int nx = 30, ny = 6;
  constexpr double h = kLength / nx;
  const auto id = [&](int i, int j, int k) { return static_cast<std::uint32_t>(i + (nx + 1) * (j + (ny + 1) * k)); };
  mesh::TetMesh bar;
  for (int k = 0; k <= ny; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) bar.vertices.emplace_back(i * h, j * h, k * h);
  constexpr std::array<std::array<int, 4>, 6> cut{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};  // bit a: along axis a
  for (int k = 0; k < ny; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (const auto& t : cut) {
          std::array<std::uint32_t, 4> corner{};
          for (std::size_t c = 0; c < 4; ++c) corner[c] = id(i + (t[c] & 1), j + ((t[c] >> 1) & 1), k + (t[c] >> 2));
          bar.tetrahedra.push_back(corner);
        }
  std::vector<mesh::HeldVertex> held;
  std::vector<mesh::VertexForce> forces;
  for (int k = 0; k <= ny; ++k)
    for (int j = 0; j <= ny; ++j) {
      held.push_back({id(0, j, k), Vec3::Zero()});
      const double area = h * h * (j % ny == 0 ? 0.5 : 1) * (k % ny == 0 ? 0.5 : 1);
      forces.push_back({id(nx, j, k), Vec3(0, 0, stress * area)});
    }
  return mesh::solve_elastic(bar, kMaterial, held, forces)[id(nx, ny / 2, ny / 2)][2];
}

}  // namespace

int main() {
  const PointCloudField field(scattered(), 2.6 * kSpacing);
  double worst_linear = 0;
  for (const Vec3& x : {Vec3(3, 4, 5), Vec3(31, 0.5, 11), Vec3(59, 6, 6)}) {
    const Reading r = field.at(x);
    Vec3 read = Vec3::Zero();
    for (std::size_t n = 0; n < r.points.size(); ++n)
      read += r.share[n] * field.points()[static_cast<std::size_t>(r.points[n])];
    worst_linear = std::max(worst_linear, (read - x).norm());
  }

  const double stress = 0.01;
  const auto pulled = solve(field, {stress, 0, 0});
  const Vec3 end = pulled({kLength, kSide / 2, kSide / 2});
  const double narrower = pulled({kLength / 2, kSide, kSide / 2})[1] - pulled({kLength / 2, 0, kSide / 2})[1];
  const double exact = stress / kMaterial.young_mpa * kLength;
  const double exact_narrower = -kMaterial.poisson * stress / kMaterial.young_mpa * kSide;
  std::printf("%zu points; a linear motion is read to %.0e mm\n", field.points().size(), worst_linear);
  std::printf("pulled: %.4f mm longer (Hooke: %.4f), %.4f mm narrower (%.4f)\n", end[0], exact, -narrower,
              -exact_narrower);

  const double bent = solve(field, {0, 0, stress / 20})({kLength, kSide / 2, kSide / 2})[2];
  const double judge = bend_of_tetrahedra(stress / 20);
  std::printf("bent: its end moves %.3f mm; by 6480 tetrahedra %.3f mm\n", bent, judge);
  return worst_linear < 1e-9 && std::abs(end[0] / exact - 1) < 0.01 && std::abs(narrower / exact_narrower - 1) < 0.02 &&
                 std::abs(bent / judge - 1) < 0.1
             ? 0
             : 1;
}
