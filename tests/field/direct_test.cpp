// A direct sparse solution as the judge of the steady solvers: no iteration, no stopping rule, nothing shared with
// them.
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include "dynasurf/field/band.hpp"
#include "dynasurf/field/gvf.hpp"

#include "support/edge_maps.hpp"

namespace dynasurf::field {
namespace {

using test::box;

/// Columns x, y, z of the solution of (b - sum rate_a d2/da2) u = b grad f; `b_of` makes b from |grad f|^2.
template <class F>
Eigen::MatrixX3d direct_solution(const Image& f, const Vec3& rate, F b_of) {
  const Grid& g = f.grid;
  const auto n = static_cast<Eigen::Index>(g.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d rhs(n, 3);
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        const auto row = static_cast<Eigen::Index>(g.index(i, j, k));
        Vec3 slope = Vec3::Zero();
        for (int a = 0; a < 3; ++a) {
          const auto axis = static_cast<std::size_t>(a);
          Index3 low{i, j, k}, high = low;
          for (Index3* beside : {&low, &high}) {
            Index3 v = *beside;
            v[axis] += beside == &low ? -1 : 1;
            if (!g.contains(v[0], v[1], v[2])) continue;
            *beside = v;
            entries.emplace_back(row, row, rate[a]);
            entries.emplace_back(row, static_cast<Eigen::Index>(g.index(v[0], v[1], v[2])), -rate[a]);
          }
          if (low[axis] < high[axis])
            slope[a] = (double(f(high[0], high[1], high[2])) - double(f(low[0], low[1], low[2]))) /
                       ((high[axis] - low[axis]) * g.spacing[a]);
        }
        const double b = b_of(slope.squaredNorm());
        entries.emplace_back(row, row, b);
        rhs.row(row) = b * slope.transpose();
      }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(rhs);
}

double error_of(const VectorField& u, const Eigen::MatrixX3d& exact) {
  double apart = 0;
  for (Eigen::Index v = 0; v < exact.rows(); ++v) {
    const auto at = static_cast<std::size_t>(v);
    apart += (Vec3(u.x[at], u.y[at], u.z[at]) - exact.row(v).transpose()).squaredNorm();
  }
  return std::sqrt(apart) / exact.norm();
}

Vec3 rates(const Grid& g, double mu) { return mu * g.spacing.cwiseAbs2().cwiseInverse(); }

const auto plain = [](double slope_squared) { return slope_squared; };

TEST(DirectSolution, AgreesWithTheSteadySolverInTwoAndThreeDimensions) {
  std::uint32_t seed = 7;
  for (const Grid& g : {box(12, 11, 10), box(9, 16, 7, {1, 1, 3}), box(31, 28, 1), box(1, 20, 17, {1, 2, 1}),
                        box(40, 3, 2, {0.5, 1, 4})})
    for (double mu : {1e-3, 0.2, 100.0}) {
      const Image f = test::noise(g, ++seed);
      const Eigen::MatrixX3d exact = direct_solution(f, rates(g, mu), plain);
      const FlowResult r = flow_field(f, SteadyGvf{.mu = mu, .tolerance = 1e-4});
      EXPECT_LT(error_of(r.field, exact), *r.error + 5e-7);
      EXPECT_LT(error_of(dense_field(band_field(f, BandGvf{.mu = mu, .tolerance = 1e-4}).field), exact), 2e-4);
    }
}

TEST(DirectSolution, AgreesOnABinaryBorderAndForGgvf) {
  const Grid g = box(16, 15, 14);
  const Image f = test::border_of(g, [](const Vec3& p) { return p.norm() < 4.5 + 0.1 * p[0]; });
  const FlowResult gvf = flow_field(f, SteadyGvf{.mu = 0.2, .tolerance = 1e-4});
  EXPECT_LT(error_of(gvf.field, direct_solution(f, rates(g, 0.2), plain)), *gvf.error);
  double steepest = 0;
  direct_solution(f, rates(g, 1), [&](double s) { return steepest = std::max(steepest, s); });
  const auto generalised = [&](double s) { return std::expm1(std::sqrt(s / steepest) / 0.1); };
  const FlowResult ggvf = flow_field(f, SteadyGgvf{.k = 0.1, .tolerance = 1e-4});
  EXPECT_LT(error_of(ggvf.field, direct_solution(f, rates(g, 1), generalised)), *ggvf.error);
}

}  // namespace
}  // namespace dynasurf::field
