#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/contours.hpp"

namespace dynasurf::dynamics {
namespace {

template <class Inside>
Image painted(Inside inside) {
  Grid grid;
  grid.dims = {64, 64, 1};
  Image plane(grid);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) plane(i, j, 0) = inside(Vec2(i, j)) ? 1.0F : 0.0F;
  return plane;
}

Image disk() {
  return painted([](const Vec2& p) { return (p - Vec2(32, 31)).norm() < 15.5; });
}

double farthest_external(const Net& net, const Vec2& centre, double radius) {
  double most = 0;
  for (std::size_t v = 0; v < net.nodes.size(); ++v)
    if (net.external[v]) most = std::max(most, std::abs((net.nodes[v] - centre).norm() - radius));
  return most;
}

TEST(ActiveNet, PutsItsExternalNodesOnTheBorderOfAConvexBlob) {
  const Net net = fit_net(disk(), {});
  const NetShape shape = shape_of(net);
  EXPECT_EQ(shape.parts, 1);
  EXPECT_EQ(shape.holes, 0);
  EXPECT_EQ(std::count(net.external.begin(), net.external.end(), 1), 76);
  EXPECT_LE(farthest_external(net, {32, 31}, 15.5), 1.0);
}

TEST(ActiveNet, FindsDarkObjectsToo) {
  Image plane = disk();
  for (float& v : plane.values) v = 5 - 3 * v;
  ActiveNet o;
  o.dark_objects = true;
  EXPECT_EQ(fit_net(plane, o).nodes, fit_net(disk(), {}).nodes);
}

TEST(TopologicalNet, KeepsOneNetOnAConvexBlob) {
  const std::vector<Net> nets = fit_topological_nets(disk(), {});
  ASSERT_EQ(nets.size(), 1U);
  EXPECT_EQ(shape_of(nets[0]).holes, 0);
  EXPECT_LE(farthest_external(nets[0], {32, 31}, 15.5), 1.0);
}

TEST(TopologicalNet, SplitsBetweenTwoBlobs) {
  const Vec2 a(18, 30), b(46, 34);
  const std::vector<Net> nets =
      fit_topological_nets(painted([&](const Vec2& p) { return (p - a).norm() < 9 || (p - b).norm() < 8; }), {});
  ASSERT_EQ(nets.size(), 2U);
  for (const Net& net : nets) {
    Vec2 mean = Vec2::Zero();
    for (const Vec2& p : net.nodes) mean += p / static_cast<double>(net.nodes.size());
    EXPECT_LT(std::min((mean - a).norm(), (mean - b).norm()), 2);
    EXPECT_EQ(shape_of(net).parts, 1);
    EXPECT_GT(net.broken_links, 0);
  }
}

TEST(TopologicalNet, FindsTheHoleOfARing) {
  const Vec2 centre(32, 32);
  const std::vector<Net> nets = fit_topological_nets(
      painted([&](const Vec2& p) { return (p - centre).norm() < 22 && (p - centre).norm() > 10; }), {});
  ASSERT_EQ(nets.size(), 1U);
  EXPECT_EQ(shape_of(nets[0]).holes, 1);
}

TEST(TopologicalNet, FindsNothingWithoutContrast) {
  EXPECT_TRUE(fit_topological_nets(painted([](const Vec2&) { return true; }), {}).empty());
  EXPECT_TRUE(fit_net(painted([](const Vec2&) { return false; }), {}).nodes.empty());
}

TEST(ActiveNet, RefusesPlanesThatAreTooSmallOrNotFinite) {
  Grid grid;
  grid.dims = {7, 20, 1};
  EXPECT_THROW(fit_net(Image(grid), {}), InputError);
  Image bad = disk();
  bad.values[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(fit_topological_nets(bad, {}), InputError);
  ActiveNet o;
  o.rows = 1;
  EXPECT_THROW(fit_net(disk(), o), OptionError);
}

}  // namespace
}  // namespace dynasurf::dynamics
