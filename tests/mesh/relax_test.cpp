#include "dynasurf/mesh/detail/relax.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::mesh {
namespace {

/// Degrees between the normals of the two triangles of a pair.
double bend_deg(const TriMesh& pair) {
  Vec3 normals[2];
  for (int t = 0; t < 2; ++t) {
    const auto& c = pair.triangles[t];
    normals[t] = (pair.vertices[c[1]] - pair.vertices[c[0]]).cross(pair.vertices[c[2]] - pair.vertices[c[0]]);
  }
  return std::atan2(normals[0].cross(normals[1]).norm(), normals[0].dot(normals[1])) * 180 / std::numbers::pi;
}

/// Two triangles across the diagonal from 0 to 1, whose other diagonal makes larger angles and bends them more.
TriMesh pair_that_would_bend(double height) {
  return {{{0, 0, 0}, {4, 0, 0}, {3.7, 1, height}, {3.7, -0.9, height}}, {{0, 1, 2}, {1, 0, 3}}};
}

TEST(FlipToLargerAngles, BendsTheSurfaceUpToTheLimitAndNotBeyond) {
  for (const double height : {0.1, 0.3}) {
    const TriMesh pair = pair_that_would_bend(height);
    TriMesh flipped = pair;
    flipped.triangles = {{3, 2, 0}, {2, 3, 1}};
    ASSERT_GT(bend_deg(flipped), bend_deg(pair));
    ASSERT_GT(triangle_quality(flipped).smallest_angle_deg, triangle_quality(pair).smallest_angle_deg);
    for (const double limit : {bend_deg(flipped) - 1, bend_deg(flipped) + 1}) {
      SurfaceEditor surface(pair, SurfaceEditor::Boundary::kept);
      EXPECT_EQ(flip_to_larger_angles(surface, limit), limit > bend_deg(flipped) ? 1 : 0) << height << " " << limit;
    }
  }
}

double smallest_angle_of_fan_deg(TriMesh fan, const Vec3& middle) {
  fan.vertices.back() = middle;
  return triangle_quality(fan).smallest_angle_deg;
}

// Around a vertex among six others the best place lies neither towards their middle nor in any direction told before.
TEST(ImproveSmallestAngle, PutsAVertexNearlyWhereItsAnglesAreLargest) {
  for (int turn = 0; turn < 8; ++turn) {
    const double reach[] = {1, 1.9, 0.8, 1.3, 0.7, 1.6};
    TriMesh fan;
    for (int k = 0; k < 6; ++k) {
      const double angle = (60 * k + 45 * turn) * std::numbers::pi / 180;
      fan.vertices.emplace_back(reach[k] * std::cos(angle), reach[k] * std::sin(angle), 0);
      fan.triangles.push_back({static_cast<std::uint32_t>(k), static_cast<std::uint32_t>((k + 1) % 6), 6});
    }
    fan.vertices.emplace_back(0.45, -0.3, 0);
    double best = 0;
    for (double y = -1; y <= 1; y += 0.02)
      for (double x = -1; x <= 1; x += 0.02) best = std::max(best, smallest_angle_of_fan_deg(fan, {x, y, 0}));
    SurfaceEditor surface(fan, SurfaceEditor::Boundary::kept);
    EXPECT_GT(improve_smallest_angle(surface, 60, 10), best - 2) << turn << ": eight directions, halved steps";
  }
}

}  // namespace
}  // namespace dynasurf::mesh
