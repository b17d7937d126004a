#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/contours.hpp"
#include "dynasurf/field/gvf.hpp"

namespace dynasurf::dynamics {
namespace {

/// A U whose arms stand up: outside 36 x 34 px, the mouth from x = 25 to 39 and down to y = 24. Black line on white is
/// the border; here the U is filled.
bool in_u(int i, int j) { return i >= 14 && i < 50 && j >= 14 && j < 48 && !(i >= 25 && i < 39 && j >= 24); }

Image u_shape() {
  Grid grid;
  grid.dims = {64, 64, 1};
  Image plane(grid);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) plane(i, j, 0) = in_u(i, j) ? 1.0F : 0.0F;
  return plane;
}

/// Its border as white lines on black.
Image border_of_u() {
  Image edges = snake_energy(u_shape(), SnakeEnergy::gradient);
  for (float& v : edges.values) v = std::min(1.0F, -4 * v);
  return edges;
}

/// Lowest point of a contour between the arms.
double depth_reached(const Contour& c) {
  double lowest = 64;
  for (std::size_t e = 0; e < c.edges(); ++e)
    if (const Vec2 p = (c.points[e] + c.end_of_edge(e)) / 2; std::abs(p.x() - 31.5) < 3 && p.y() > 20)
      lowest = std::min(lowest, p.y());
  return lowest;
}

Contour around() { return circle_contour({31.5, 31}, 27, 1.5); }

TEST(Snake, SolvesTheCyclicBandLikeADenseMatrix) {
  for (const int n : {5, 6, 7, 40}) {
    const double main = 4.1, next = -1.3, second = 0.4;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixXd b(n, 2);
    std::vector<Vec2> right;
    for (int i = 0; i < n; ++i) {
      a(i, i) += main;
      a(i, (i + 1) % n) += next, a(i, (i + n - 1) % n) += next;
      a(i, (i + 2) % n) += second, a(i, (i + n - 2) % n) += second;
      right.push_back({std::sin(3.0 * i), std::cos(1.7 * i)});
      b.row(i) = right.back().transpose();
    }
    const Eigen::MatrixXd x = a.fullPivLu().solve(b);
    const std::vector<Vec2> ours = solve_cyclic_pentadiagonal(main, next, second, right);
    for (int i = 0; i < n; ++i)
      EXPECT_LT((ours[static_cast<std::size_t>(i)].transpose() - x.row(i)).norm(), 1e-12) << n;
  }
}

TEST(Snake, ShrinksACircleAtTheRateOfItsTension) {
  // A regular n-gon is an eigenvector of the second difference: 2 cos(2 pi / n) - 2, of the fourth: its square.
  Snake o;
  o.respace_every = 0;
  o.max_steps = 10;
  o.step = 5;
  const Contour start = circle_contour({0, 0}, 20, 4);
  const double d2 = 2 * std::cos(2 * 3.14159265358979 / static_cast<double>(start.size())) - 2;
  const double factor = 1 / (1 - o.step * (o.alpha * d2 - o.beta * d2 * d2));
  const ContourResult r = evolve_snake(start, {}, o);
  for (const Vec2& p : r.contour.points) EXPECT_NEAR(p.norm(), 20 * std::pow(factor, 10), 1e-9);
}

TEST(Snake, WithTheFourEnergiesStopsAtTheMouthOfAU) {
  const Image u = u_shape();
  Image lines = border_of_u();  // black on white
  for (float& v : lines.values) v = 1 - v;
  for (const SnakeEnergy kind : {SnakeEnergy::gradient, SnakeEnergy::smoothed_gradient, SnakeEnergy::intensity,
                                 SnakeEnergy::smoothed_intensity}) {
    const bool of_lines = kind == SnakeEnergy::intensity || kind == SnakeEnergy::smoothed_intensity;
    const field::VectorField pull = scaled_to_one(force_of(snake_energy(of_lines ? lines : u, kind, 2)));
    const ContourResult r = evolve_snake(around(), pull, {});
    EXPECT_GT(depth_reached(r.contour), 40) << word_of(kind);  // the floor of the U lies at 23.5
  }
}

TEST(Snake, WithGradientVectorFlowEntersTheU) {
  field::VectorField flow = field::flow_field(border_of_u(), field::SteadyGvf{.mu = 0.2}).field;
  // Directions alone, as in the paper of Xu and Prince: far from the border the flow is weak.
  for (std::size_t n = 0; n < flow.x.size(); ++n)
    if (const float length = std::hypot(flow.x[n], flow.y[n]); length > 0) flow.x[n] /= length, flow.y[n] /= length;
  Snake o;
  o.alpha = 0.1;
  const ContourResult r = evolve_snake(around(), flow, o);
  EXPECT_LT(depth_reached(r.contour), 26);
}

TEST(Snake, RefusesWhatItCannotMove) {
  EXPECT_THROW(evolve_snake({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}, {}, {}), InputError);
  Contour open = circle_contour({0, 0}, 9, 1);
  open.closed = false;
  EXPECT_THROW(evolve_snake(open, {}, {}), InputError);
  EXPECT_THROW(solve_cyclic_pentadiagonal(1, 0, 0, {{0, 0}, {0, 0}}), InputError);
}

}  // namespace
}  // namespace dynasurf::dynamics
