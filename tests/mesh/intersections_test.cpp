#include "dynasurf/mesh/intersections.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/predicates.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

Pairs pairs_of(const TriMesh& mesh) { return self_intersections(mesh).pairs; }

/// Two triangles given by six corners; equal corners are one vertex.
TriMesh two_triangles(const std::vector<Vec3>& corners) {
  TriMesh mesh;
  std::array<std::uint32_t, 6> index{};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto at = std::find(mesh.vertices.begin(), mesh.vertices.end(), corners[i]);
    index[i] = static_cast<std::uint32_t>(at - mesh.vertices.begin());
    if (at == mesh.vertices.end()) mesh.vertices.push_back(corners[i]);
  }
  mesh.triangles = {{index[0], index[1], index[2]}, {index[3], index[4], index[5]}};
  return mesh;
}

TEST(Orient3d, IsNegativeOnTheSideThatSeesTheTriangleCounterClockwise) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(orient3d(a, b, c, {0, 0, 1}), -1);
  EXPECT_EQ(orient3d(a, b, c, {0, 0, -1}), 1);
  EXPECT_EQ(orient3d(a, b, c, {5, -7, 0}), 0);
}

TEST(Orient3d, DecidesTheLastBit) {
  // Points around one in the plane x = y, apart by the smallest step a double can make. The plain formula rounds the
  // differences to the corners and takes many of them for points of the plane or of its other side.
  const Vec3 a(12, 12, 0.1), b(24, 24, 0.1), c(24, 24, 7.3);
  const double step = std::ldexp(1.0, -53);
  const int below = orient3d(a, b, c, {0, 1, 0.3});
  for (int i = 0; i < 32; ++i)
    for (int j = 0; j < 32; ++j) {
      const Vec3 d(0.5 + i * step, 0.5 + j * step, 0.3);
      const int side = (d[1] > d[0]) - (d[1] < d[0]);
      ASSERT_EQ(orient3d(a, b, c, d), side * below) << i << " " << j;
      for (const int axis : {0, 1, 2}) {
        const Vec3 u = axis == 0 ? Vec3(0, 12, 12) : axis == 1 ? Vec3(12, 0, 12) : Vec3(12, 12, 0);
        Vec3 p = Vec3::Zero();
        p[(axis + 1) % 3] = d[0];
        p[(axis + 2) % 3] = d[1];
        ASSERT_EQ(orient2d(u, 2 * u, p, axis), side) << i << " " << j;
      }
    }
}

TEST(Orient3d, ChangesItsSignWithEachExchange) {
  std::mt19937 random(7);
  const auto coordinate = [&] { return static_cast<double>(random() % 1000) * 0.1; };
  for (int i = 0; i < 2000; ++i) {
    Vec3 p[4];
    for (Vec3& x : p) x = {coordinate(), coordinate(), coordinate()};
    if (i % 2 == 0) p[3] = p[0] + (p[1] - p[0]) * 0.5 + (p[2] - p[0]) * 0.25;  // nearly in the plane
    const int sign = orient3d(p[0], p[1], p[2], p[3]);
    EXPECT_EQ(orient3d(p[1], p[0], p[2], p[3]), -sign);
    EXPECT_EQ(orient3d(p[0], p[1], p[3], p[2]), -sign);
    EXPECT_EQ(orient3d(p[3], p[1], p[2], p[0]), -sign);
    EXPECT_EQ(orient3d(p[1], p[2], p[0], p[3]), sign);
  }
}

TEST(Orient3d, AgreesWithWholeNumbersNearAndInAPlane) {
  std::mt19937 random(11);
  const auto whole = [&](int most) { return static_cast<int>(random() % (2 * static_cast<unsigned>(most))) - most; };
  int in_plane = 0;
  for (int n = 0; n < 20000; ++n) {
    std::array<std::array<std::int64_t, 3>, 4> p;
    for (auto& point : p)
      for (auto& x : point) x = whole(1 << 25);
    const int along = whole(4), across = whole(4);
    for (std::size_t i = 0; i < 3; ++i)
      p[3][i] = p[0][i] + along * (p[1][i] - p[0][i]) + across * (p[2][i] - p[0][i]) + (n % 3 == 0 ? 0 : whole(2));
    __extension__ using Wide = __int128;
    std::array<std::array<Wide, 3>, 3> u;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t i = 0; i < 3; ++i) u[r][i] = p[r][i] - p[3][i];
    const auto& [a, b, c] = u;
    const Wide det =
        a[2] * (b[0] * c[1] - c[0] * b[1]) + b[2] * (c[0] * a[1] - a[0] * c[1]) + c[2] * (a[0] * b[1] - b[0] * a[1]);
    std::array<Vec3, 4> x;
    for (std::size_t r = 0; r < 4; ++r)
      x[r] = {static_cast<double>(p[r][0]), static_cast<double>(p[r][1]), static_cast<double>(p[r][2])};
    ASSERT_EQ(orient3d(x[0], x[1], x[2], x[3]), (det > 0) - (det < 0)) << n;
    in_plane += det == 0;
  }
  EXPECT_GT(in_plane, 5000);
}

TEST(SelfIntersections, ABallHasNone) {
  for (int level = 0; level <= 4; ++level) {
    TriMesh ball = icosphere(level);
    for (Vec3& p : ball.vertices) p = Vec3(30, 25, 47).cwiseProduct(p) + Vec3(0.1, 0.2, 0.3);
    EXPECT_TRUE(self_intersections(ball).free()) << level;
  }
}

TEST(SelfIntersections, AFlatLatticeHasNoneThoughAllItsTrianglesLieInOnePlane) {
  TriMesh lattice;
  for (std::uint32_t y = 0; y < 12; ++y)
    for (std::uint32_t x = 0; x < 12; ++x) {
      lattice.vertices.push_back({0.1 * x, 0.1 * y, 0.1 * x + 0.1 * y});
      const std::uint32_t v = 12 * y + x;
      if (x == 11 || y == 11) continue;
      lattice.triangles.push_back({v, v + 1, v + 12});
      lattice.triangles.push_back({v + 1, v + 13, v + 12});
    }
  EXPECT_TRUE(self_intersections(lattice).free());
}

TEST(SelfIntersections, TwoBallsThatOverlapMeetAndTwoApartDoNot) {
  for (const double distance : {1.7, 2.1}) {
    TriMesh both = icosphere(2);
    const TriMesh one = both;
    for (const Vec3& p : one.vertices) both.vertices.push_back(p + Vec3(distance, 0, 0));
    for (const auto& t : one.triangles) both.triangles.push_back({t[0] + 162, t[1] + 162, t[2] + 162});
    EXPECT_EQ(pairs_of(both).empty(), distance > 2) << distance;
    for (const auto& [s, t] : pairs_of(both)) EXPECT_TRUE(s < 320 && t >= 320);
  }
}

TEST(SelfIntersections, ABallWithAVertexPushedThroughItsFarSideMeetsItself) {
  TriMesh ball = icosphere(2);
  EXPECT_TRUE(self_intersections(ball).free());
  ball.vertices[0] *= -1.5;
  const Pairs pairs = pairs_of(ball);
  EXPECT_FALSE(pairs.empty());
  // Only the triangles around that vertex moved, so each pair has one of them.
  const auto moved = [&](std::uint32_t t) {
    const auto& c = ball.triangles[t];
    return c[0] == 0 || c[1] == 0 || c[2] == 0;
  };
  for (const auto& [s, t] : pairs) EXPECT_TRUE(moved(s) || moved(t));
}

TEST(SelfIntersections, CountsFoldsTwinsAndTouches) {
  const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  // Common edge: standing up, lying flat on the other side, folded back.
  EXPECT_TRUE(pairs_of(two_triangles({o, x, y, o, x, z})).empty());
  EXPECT_TRUE(pairs_of(two_triangles({o, x, y, o, x, -y})).empty());
  EXPECT_EQ(pairs_of(two_triangles({o, x, y, o, x, {0.5, 0.1, 0}})).size(), 1u);
  // Twins.
  EXPECT_EQ(pairs_of(two_triangles({o, x, y, y, x, o})).size(), 1u);
  // Common vertex: apart, edge upon edge, through the face, sectors overlapping in the plane.
  EXPECT_TRUE(pairs_of(two_triangles({o, x, y, o, -x, -y})).empty());
  EXPECT_EQ(pairs_of(two_triangles({o, x, y, o, 2 * x, z})).size(), 1u);
  EXPECT_EQ(pairs_of(two_triangles({o, x, y, o, {1, 1, 1}, {1, 1, -1}})).size(), 1u);
  EXPECT_EQ(pairs_of(two_triangles({o, x, y, o, {1, 1, 0}, {-1, 1, 0}})).size(), 1u);
  // No common vertex: a corner that touches a face, and one that barely misses it.
  const Vec3 in_face(0.25, 0.25, 0), above(0.25, 0.25, 1e-30);
  EXPECT_EQ(pairs_of(two_triangles({o, x, y, in_face, {0, 0, 1}, {1, 1, 1}})).size(), 1u);
  EXPECT_TRUE(pairs_of(two_triangles({o, x, y, above, {0, 0, 1}, {1, 1, 1}})).empty());
}

TEST(SelfIntersections, ReportsFlatTrianglesApart) {
  const auto found =
      self_intersections(two_triangles({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0, 1, 0}, {1, 1, 2}, {2, 1, 0}}));
  EXPECT_EQ(found.flat, (std::vector<std::uint32_t>{0}));
  EXPECT_TRUE(found.pairs.empty());
  EXPECT_FALSE(found.free());
}

// A judge that shares nothing with the code: two convex bodies are apart when, and only when, one of finitely many
// directions separates them. On a lattice of small integers it is exact.
using Int3 = std::array<int, 3>;
Int3 minus(const Int3& a, const Int3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Int3 cross(const Int3& a, const Int3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
int dot(const Int3& a, const Int3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool separated(const std::array<Int3, 3>& s, const std::array<Int3, 3>& t) {
  const Int3 ns = cross(minus(s[1], s[0]), minus(s[2], s[0])), nt = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  std::vector<Int3> directions{ns, nt};
  for (std::size_t i = 0; i < 3; ++i) {
    const Int3 es = minus(s[(i + 1) % 3], s[i]), et = minus(t[(i + 1) % 3], t[i]);
    directions.push_back(cross(ns, es));
    directions.push_back(cross(nt, et));
    for (std::size_t j = 0; j < 3; ++j) directions.push_back(cross(es, minus(t[(j + 1) % 3], t[j])));
  }
  for (const Int3& d : directions) {
    const auto [s_low, s_high] = std::minmax({dot(d, s[0]), dot(d, s[1]), dot(d, s[2])});
    const auto [t_low, t_high] = std::minmax({dot(d, t[0]), dot(d, t[1]), dot(d, t[2])});
    if (s_high < t_low || t_high < s_low) return true;
  }
  return false;
}

TEST(SelfIntersections, AgreesWithSeparatingDirectionsOnTrianglesThatTouchInEveryWay) {
  std::mt19937 random(11);
  int met = 0, apart = 0;
  for (int trial = 0; trial < 60000; ++trial) {
    // Few places, so that touching, overlapping in a plane and crossing in an edge are common.
    const unsigned places = 3 + static_cast<unsigned>(trial) % 4;
    std::array<Int3, 3> s{}, t{};
    for (auto* triangle : {&s, &t})
      for (Int3& p : *triangle)
        for (int& c : p) c = static_cast<int>(random() % places);
    TriMesh mesh;
    for (const auto* triangle : {&s, &t})
      for (const Int3& p : *triangle) mesh.vertices.push_back(Vec3(p[0], p[1], p[2]));
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    const auto found = self_intersections(mesh);
    const Int3 none{0, 0, 0};
    const bool s_flat = cross(minus(s[1], s[0]), minus(s[2], s[0])) == none;
    const bool t_flat = cross(minus(t[1], t[0]), minus(t[2], t[0])) == none;
    ASSERT_EQ(found.flat.size(), static_cast<std::size_t>(s_flat + t_flat));
    if (s_flat || t_flat) continue;
    ASSERT_EQ(found.pairs.empty(), separated(s, t)) << trial;
    ++(found.pairs.empty() ? apart : met);
  }
  EXPECT_GT(met, 5000);
  EXPECT_GT(apart, 5000);
}

bool in_cone(const Int3& x, const Int3& a, const Int3& b, const Int3& normal) {
  return dot(cross(a, x), normal) >= 0 && dot(cross(x, b), normal) >= 0;
}

/// Do the sectors of the plane between a0 and a1, and between b0 and b1, share a direction? They do when some
/// combination s a0 + t a1 = u b0 + v b1 has no negative factor: three equations for four factors, by Cramer's rule.
bool sectors_meet(const Int3& a0, const Int3& a1, const Int3& b0, const Int3& b1) {
  const auto det = [](const Int3& p, const Int3& q, const Int3& r) { return dot(cross(p, q), r); };
  const std::array<int, 4> factors{det(a1, b0, b1), -det(a0, b0, b1), -det(a0, a1, b1), det(a0, a1, b0)};
  if (factors != std::array<int, 4>{})
    return std::all_of(factors.begin(), factors.end(), [](int f) { return f >= 0; }) ||
           std::all_of(factors.begin(), factors.end(), [](int f) { return f <= 0; });
  const Int3 na = cross(a0, a1), nb = cross(b0, b1);  // all in one plane
  return in_cone(b0, a0, a1, na) || in_cone(b1, a0, a1, na) || in_cone(a0, b0, b1, nb) || in_cone(a1, b0, b1, nb);
}

TEST(SelfIntersections, AgreesWithCramersRuleOnTrianglesThatShareAVertex) {
  std::mt19937 random(13);
  int met = 0, apart = 0;
  for (int trial = 0; trial < 60000; ++trial) {
    const unsigned places = 3 + static_cast<unsigned>(trial) % 3;
    std::array<Int3, 5> p{};
    for (Int3& x : p)
      for (int& c : x) c = static_cast<int>(random() % places);
    TriMesh mesh;
    for (const Int3& x : p) mesh.vertices.push_back(Vec3(x[0], x[1], x[2]));
    mesh.triangles = {{1, 2, 0}, {3, 0, 4}};
    const auto found = self_intersections(mesh);
    if (!found.flat.empty()) continue;
    ASSERT_EQ(!found.pairs.empty(),
              sectors_meet(minus(p[1], p[0]), minus(p[2], p[0]), minus(p[3], p[0]), minus(p[4], p[0])))
        << trial;
    ++(found.pairs.empty() ? apart : met);
  }
  EXPECT_GT(met, 5000);
  EXPECT_GT(apart, 5000);
}

TEST(SelfIntersections, AreTheSameForAnyNumberOfThreads) {
  TriMesh ball = icosphere(4);
  for (std::size_t v = 0; v < ball.vertices.size(); v += 50) ball.vertices[v] *= -1.2;
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return pairs_of(ball);
  };
  const Pairs one = with_threads(1);
  EXPECT_GT(one.size(), 100u);
  EXPECT_EQ(with_threads(4), one);
}

TEST(SelfIntersections, RefusesAMeshThatIsNone) {
  TriMesh bad_index = icosphere(0), not_finite = bad_index;
  bad_index.triangles[3][1] = 12;
  not_finite.vertices[5][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(self_intersections(bad_index), InputError);
  EXPECT_THROW(self_intersections(not_finite), InputError);
  EXPECT_TRUE(self_intersections(TriMesh{}).free());
}

}  // namespace
}  // namespace dynasurf::mesh
