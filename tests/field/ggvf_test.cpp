#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/gvf.hpp"

#include "support/edge_maps.hpp"
#include "support/vector_fields.hpp"

namespace dynasurf::field {
namespace {

using test::at;
using test::border_of;
using test::box;
using test::largest;
using test::same_bytes;

Image egg(const Grid& g) {
  const Vec3 half = Vec3(g.dims[0], g.dims[1], g.dims[2]).cwiseProduct(g.spacing) / 2;
  return border_of(g, [&](const Vec3& p) {
    const Vec3 q = p.cwiseQuotient(half) - Vec3(0.1, -0.1, 0.05);
    return q.norm() < 0.5 + 0.1 * q[2];
  });
}

/// Equations 3.39-3.42 one voxel at a time in double precision: the judge of the fast loops.
VectorField plain_ggvf(const Image& f, const Ggvf& o, double dt) {
  const Grid& g = f.grid;
  Volume<Vec3> gradient(g, Vec3::Zero()), from = gradient, to = gradient;
  double steepest = 0;
  const auto each = [&](auto body) {
    for (int k = 0; k < g.dims[2]; ++k)
      for (int j = 0; j < g.dims[1]; ++j)
        for (int i = 0; i < g.dims[0]; ++i) body(i, j, k);
  };
  each([&](int i, int j, int k) {
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      Index3 low{i, j, k}, high = low;
      low[axis] = std::max(low[axis] - 1, 0);
      high[axis] = std::min(high[axis] + 1, g.dims[axis] - 1);
      if (low[axis] < high[axis])
        gradient(i, j, k)[a] = (double(f(high[0], high[1], high[2])) - double(f(low[0], low[1], low[2]))) /
                               ((high[axis] - low[axis]) * g.spacing[a]);
    }
    steepest = std::max(steepest, gradient(i, j, k).norm());
  });
  Vec3 rate;
  for (int a = 0; a < 3; ++a)
    rate[a] = dt / (o.scheme == GvfScheme::thesis ? g.spacing.prod() : g.spacing[a] * g.spacing[a]);
  from = gradient;
  for (int n = 0; n < o.iterations; ++n) {
    each([&](int i, int j, int k) {
      const Vec3 u = from(i, j, k);
      const double spread = std::exp(-gradient(i, j, k).norm() / (o.k * steepest));
      const Vec3 flow = rate[0] * (from.clamped(i - 1, j, k) + from.clamped(i + 1, j, k) - 2 * u) +
                        rate[1] * (from.clamped(i, j - 1, k) + from.clamped(i, j + 1, k) - 2 * u) +
                        rate[2] * (from.clamped(i, j, k - 1) + from.clamped(i, j, k + 1) - 2 * u);
      to(i, j, k) = u + spread * flow + (1 - spread) * dt * (gradient(i, j, k) - u);
    });
    std::swap(from, to);
  }
  VectorField out(g);
  for (std::size_t v = 0; v < g.size(); ++v) {
    out.x[v] = static_cast<float>(from.values[v][0]);
    out.y[v] = static_cast<float>(from.values[v][1]);
    out.z[v] = static_cast<float>(from.values[v][2]);
  }
  return out;
}

TEST(Ggvf, FollowsThePrintedSchemeInTwoAndThreeDimensions) {
  for (const Grid& g : {box(21, 18, 11, {1, 1, 2}), box(33, 17, 1)})
    for (GvfScheme scheme : {GvfScheme::thesis, GvfScheme::metric})
      for (double k : {0.05, 0.2}) {
        const Image f = g.dims[2] == 1 ? test::noise(g, 4) : egg(g);
        const Ggvf o{.k = k, .iterations = 40, .scheme = scheme};
        const FlowResult r = flow_field(f, o);
        EXPECT_EQ(r.iterations, 40);
        const VectorField assess = plain_ggvf(f, o, r.step);
        const double scale = largest(assess);
        // 40 roundings of 6e-8 each, of numbers below the scale.
        for (std::size_t v = 0; v < g.size(); ++v) {
          ASSERT_NEAR(r.field.x[v], assess.x[v], 3e-6 * scale);
          ASSERT_NEAR(r.field.y[v], assess.y[v], 3e-6 * scale);
          ASSERT_NEAR(r.field.z[v], assess.z[v], 3e-6 * scale);
        }
      }
}

TEST(Ggvf, EndsWhereTheSteadySolverStands) {
  const Image f = egg(box(18, 17, 16));
  const VectorField walked =
      flow_field(f, Ggvf{.iterations = 30000, .step_divisor = 7, .scheme = GvfScheme::metric}).field;
  const VectorField steady = flow_field(f, SteadyGgvf{.tolerance = 1e-5}).field;
  for (std::size_t v = 0; v < f.values.size(); ++v) ASSERT_NEAR(steady.x[v], walked.x[v], 2e-4 * largest(walked));
}

TEST(Ggvf, IsZeroOnAConstantMapAndStandsStillOnALinearOne) {
  EXPECT_EQ(largest(flow_field(Image(box(5, 6, 7), 0.7f), Ggvf{}).field), 0);
  const Grid g = box(9, 8, 7, {2, 1, 4});
  const Image f = test::drawn(g, [](const Vec3& p) { return p[0] / 8 - p[1] / 4 + p[2] / 16; });
  for (const float x : flow_field(f, Ggvf{}).field.x) ASSERT_EQ(x, 1.0f / 8);
}

TEST(Ggvf, EntersANarrowIndentationFurtherThanGvf) {
  // A block with a slot three pixels wide from its top down to row 15. In the middle of the slot nothing but diffusion
  // speaks: GVF mixes in what the field does beyond the walls, GGVF holds the walls and passes on what its end says.
  const auto is_block = [](int i, int j) {
    return i >= 10 && i <= 50 && j >= 5 && j <= 50 && !(i >= 30 && i <= 32 && j >= 15);
  };
  Image f(box(61, 61, 1));
  for (int j = 0; j < 61; ++j)
    for (int i = 0; i < 61; ++i) f(i, j, 0) = is_block(i, j) ? 1.0f : 0.0f;
  const auto reach = [&](const VectorField& u) {  // the first row where the field no longer points down to the end
    int j = 17;
    while (j < 49 && at(u, 31, j, 0)[1] < -1e-6 * largest(u)) ++j;
    return j;
  };
  const int gvf = reach(flow_field(f, SteadyGvf{.mu = 0.2, .tolerance = 1e-5}).field);
  const int ggvf = reach(flow_field(f, SteadyGgvf{.k = 0.05, .tolerance = 1e-5}).field);
  EXPECT_GE(ggvf, gvf + 3);  // 26 against 22
}

TEST(Ggvf, IsStableBelowItsBoundAndSafeStepKeepsIt) {
  const Image f = test::noise(box(16, 16, 16, {1, 1, 2}), 3);
  Ggvf o{.k = 0.1, .iterations = 2000, .scheme = GvfScheme::metric, .safe_step = false};
  const double bound = stable_step(f, o), cell = f.grid.spacing.prod();
  o.step_divisor = cell / (0.98 * bound);
  EXPECT_FALSE(flow_field(f, o).diverged);
  o.step_divisor = cell / (4 * bound);
  const FlowResult bad = flow_field(f, o);
  EXPECT_TRUE(bad.diverged);
  EXPECT_TRUE(std::isfinite(largest(bad.field)));
  o.safe_step = true;
  o.iterations = 20;
  const FlowResult safe = flow_field(f, o);
  EXPECT_FALSE(safe.diverged);
  EXPECT_NEAR(safe.step, 0.95 * bound, 1e-12);
}

TEST(Ggvf, HasTheSameBytesForAnyNumberOfThreads) {
  const Image f = egg(box(40, 37, 41));
  VectorField one;
  {
    const ThreadLimit limit(1);
    one = flow_field(f, Ggvf{}).field;
  }
  const ThreadLimit limit(3);
  EXPECT_TRUE(same_bytes(flow_field(f, Ggvf{}).field, one));
}

TEST(Ggvf, RefusesBadInput) {
  EXPECT_THROW(flow_field(Image{}, Ggvf{}), InputError);
  EXPECT_THROW(flow_field(Image(box(3, 3, 3)), Ggvf{.k = 0}), OptionError);
}

}  // namespace
}  // namespace dynasurf::field
