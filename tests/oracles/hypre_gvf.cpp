// hypre as the judge of the steady fields: another multigrid, by other people, in double precision.
#include "support/hypre_gvf.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/field/gvf.hpp"

#include "support/edge_maps.hpp"

namespace dynasurf::field {
namespace {

using test::box;

class HypreOracle : public testing::Test {
 protected:
  static void SetUpTestSuite() { session = new test::MpiSession; }
  static void TearDownTestSuite() { delete session; }
  static test::MpiSession* session;
};
test::MpiSession* HypreOracle::session = nullptr;

/// |u - u*| / |u*| against hypre's field. Its residual says little of the error, so it iterates to the last digits.
double error_of(const VectorField& field, const Image& map, double mu) {
  test::HypreGvf assess(map, mu * map.grid.spacing.cwiseAbs2().cwiseInverse(), 1e-12);
  double apart = 0, size = 0;
  const std::array<const std::vector<float>*, 3> u{&field.x, &field.y, &field.z};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::vector<double> exact = assess.component(a);
    EXPECT_LT(assess.iterations, 200);
    for (std::size_t v = 0; v < exact.size(); ++v) {
      apart += std::pow(double((*u[a])[v]) - exact[v], 2);
      size += exact[v] * exact[v];
    }
  }
  return std::sqrt(apart / size);
}

TEST_F(HypreOracle, SolvesForTheSameFieldWithinTheEstimatedError) {
  const auto is_inside = [](const Vec3& p) { return p.norm() < 12 + 2 * std::sin(p[0] / 3) + 0.1 * p[2]; };
  for (const Grid& g : {box(40, 37, 41), box(48, 45, 14, {1, 1, 3}), box(64, 64, 1)})
    for (double mu : {0.01, 0.2, 10.0})
      for (double tolerance : {1e-3, 1e-5}) {
        const Image map = test::border_of(g, is_inside);
        const FlowResult r = flow_field(map, SteadyGvf{.mu = mu, .tolerance = tolerance});
        EXPECT_LT(*r.error, tolerance);
        EXPECT_LT(error_of(r.field, map, mu), *r.error + 5e-7) << mu;  // single precision ends near 5e-7
      }
}

TEST_F(HypreOracle, SolvesForTheSameFieldOfAGreyMap) {
  const Image map = test::blurred(test::noise(box(33, 30, 28, {1, 2, 1}), 5), 1.5);
  const FlowResult r = flow_field(map, SteadyGvf{.mu = 0.5, .tolerance = 1e-4});
  EXPECT_LT(error_of(r.field, map, 0.5), *r.error);
}

}  // namespace
}  // namespace dynasurf::field
