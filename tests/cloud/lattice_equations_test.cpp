#include "dynasurf/cloud/detail/lattice_equations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::cloud {
namespace {

/// Every node but the outermost ones.
Runs inner_nodes(const Lattice& l) {
  Runs runs;
  runs.first_of_slab.assign(2, 0);
  for (int k = 1; k + 1 < l.dims[2]; ++k) {
    for (int j = 1; j + 1 < l.dims[1]; ++j) {
      const std::size_t row = k * l.slab() + j * l.row();
      runs.nodes.push_back({row + 1, row + l.row() - 1});
    }
    runs.first_of_slab.push_back(runs.nodes.size());
  }
  return runs;
}

OrientedPoints some_points(const Lattice& l, std::size_t count) {
  synthetic::Random random(3);
  OrientedPoints points;
  for (std::size_t n = 0; n < count; ++n) {
    Vec3 place;
    for (int a = 0; a < 3; ++a) place[a] = l.origin[a] + l.side * (1.6 + random.uniform() * (l.dims[a] - 4.2));
    points.points.push_back(place);
    points.normals.push_back(Vec3(random.normal(), random.normal(), random.normal()).normalized());
    points.areas.push_back(0.2 + random.uniform());
  }
  return points;
}

/// The weight of node (i, j, k) for a place, half a step further along the shifted axis; 3: along none.
double weight(const Lattice& l, const Vec3& place, const std::array<int, 3>& node, int shifted) {
  double product = 1;
  for (int a = 0; a < 3; ++a) {
    const double at = (place[a] - l.origin[a]) / l.side - (a == shifted ? 0.5 : 0.0);
    product *= std::max(0.0, 1 - std::abs(at - node[static_cast<std::size_t>(a)]));
  }
  return product;
}

// Built densely from what they say, and solved by Cholesky's factors in doubles.
TEST(LatticeEquations, HaveTheSolutionOfTheDenseOnes) {
  constexpr double closeness = 4, held = -0.5;
  const Lattice l{{21, 8, 9}, 0.5, Vec3(1, -2, 3)};
  const OrientedPoints points = some_points(l, 60);
  const auto unknowns = Eigen::Index{19 * 6 * 7};
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  const auto number = [&](const std::array<int, 3>& n) -> Eigen::Index {
    for (std::size_t a = 0; a < 3; ++a)
      if (n[a] < 1 || n[a] > l.dims[static_cast<int>(a)] - 2) return -1;
    return (n[0] - 1) + 19 * ((n[1] - 1) + 6 * (n[2] - 1));
  };
  const double scale = 1 / (l.side * l.side);
  for (int k = 1; k < 8; ++k)
    for (int j = 1; j < 7; ++j)
      for (int i = 1; i < 20; ++i) {
        const std::array<int, 3> here{i, j, k};
        const Eigen::Index row = number(here);
        dense(row, row) += 6;
        for (int a = 0; a < 3; ++a)
          for (const int way : {-1, 1}) {
            std::array<int, 3> next = here;
            next[static_cast<std::size_t>(a)] += way;
            if (const Eigen::Index column = number(next); column >= 0)
              dense(row, column) -= 1;
            else
              right[row] += held;
            // The slope between both, of the points around.
            const std::array<int, 3>& lower = way < 0 ? next : here;
            for (std::size_t p = 0; p < points.points.size(); ++p)
              right[row] +=
                  way * scale * points.areas[p] * points.normals[p][a] * weight(l, points.points[p], lower, a);
          }
      }
  for (std::size_t p = 0; p < points.points.size(); ++p) {
    Eigen::VectorXd w = Eigen::VectorXd::Zero(unknowns);
    for (int k = 1; k < 8; ++k)
      for (int j = 1; j < 7; ++j)
        for (int i = 1; i < 20; ++i) w[number({i, j, k})] = weight(l, points.points[p], {i, j, k}, 3);
    ASSERT_NEAR(w.sum(), 1, 1e-12) << "a point beside held nodes";
    dense += closeness * scale * points.areas[p] * w * w.transpose();
  }
  const Eigen::VectorXd expected = dense.llt().solve(right);

  const auto error_after = [&](int iterations) {
    std::vector<float> x(l.size(), held);
    LatticeEquations(l, points, closeness).solve(inner_nodes(l), x, iterations, {});
    EXPECT_EQ(x.front(), -0.5f);
    EXPECT_EQ(x.back(), -0.5f);
    double largest = 0;
    for (int k = 1; k < 8; ++k)
      for (int j = 1; j < 7; ++j)
        for (int i = 1; i < 20; ++i) {
          const double error = x[i + j * l.row() + k * l.slab()] - expected[number({i, j, k})];
          largest = std::max(largest, std::abs(error) / expected.cwiseAbs().maxCoeff());
        }
    return largest;
  };
  EXPECT_LT(error_after(400), 1e-4) << "squared residuals of 1e-10 are enough";
  EXPECT_LT(error_after(20), 0.1);
  EXPECT_LT(error_after(1), error_after(0)) << "the last step counts";
}

}  // namespace
}  // namespace dynasurf::cloud
