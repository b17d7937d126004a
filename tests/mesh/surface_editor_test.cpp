#include "dynasurf/mesh/detail/surface_editor.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/detail/relax.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/mesh/simplify.hpp"

#include "support/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using namespace test_shapes;

long euler(const SurfaceEditor& s) { return topology(s.mesh()).euler; }

TEST(SurfaceEditor, GivesBackTheMeshItWasMadeOf) {
  const TriMesh mesh = torus(10, 3, 20, 10);
  const TriMesh back = SurfaceEditor(mesh).mesh();
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.triangles, mesh.triangles);
}

TEST(SurfaceEditor, RefusesOpenTurnedAndPinchedSurfaces) {
  TriMesh open = icosphere(1), turned = open, stray = open;
  open.triangles.pop_back();
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  stray.vertices.push_back(Vec3::Zero());
  for (const TriMesh& bad : {open, turned, stray}) EXPECT_THROW(SurfaceEditor{bad}, InputError);
}

TEST(SurfaceEditor, StaysAClosedSurfaceOfItsGenusUnderAnyChanges) {
  SurfaceEditor s(torus(10, 3, 24, 12));
  std::mt19937 random(11);
  int done[3] = {0, 0, 0};
  for (int n = 0; n < 4000; ++n) {
    const auto h = static_cast<std::uint32_t>(random() % (3 * s.triangle_slots()));
    if (!s.is_alive(h / 3)) continue;
    const std::size_t before = s.triangles();
    const Vec3 middle = 0.5 * (s.position(s.from(h)) + s.position(s.to(h)));
    const auto kind = random() % 3;
    if (kind == 0 && s.can_collapse(h)) {
      s.collapse(h, middle);
      EXPECT_EQ(s.triangles(), before - 2);
    } else if (kind == 1 && s.can_flip(h)) {
      s.flip(h);
      EXPECT_EQ(s.triangles(), before);
    } else if (kind == 2 && before < 700) {
      s.split(h, middle);
      EXPECT_EQ(s.triangles(), before + 2);
    } else {
      continue;
    }
    ++done[kind];
    if (n % 100 == 0) {
      const SurfaceCheck check = check_surface(s.mesh());
      EXPECT_TRUE(check.closed && check.manifold && check.oriented);
      EXPECT_EQ(euler(s), 0);
    }
  }
  for (const int count : done) EXPECT_GT(count, 200);
  EXPECT_EQ(s.mesh().triangles.size(), s.triangles());
}

/// A square of n by n cells with a square hole, bent to a wave.
TriMesh holed_sheet(int n, int hole) {
  TriMesh mesh;
  std::vector<std::uint32_t> id(static_cast<std::size_t>((n + 1) * (n + 1)), 0xffffffff);
  const auto vertex = [&](int i, int j) {
    std::uint32_t& v = id[static_cast<std::size_t>(j * (n + 1) + i)];
    if (v == 0xffffffff) {
      v = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back(Vec3(i, j, std::sin(0.3 * i)));
    }
    return v;
  };
  const auto is_hole = [&](int i) { return 2 * i > n - hole && 2 * i < n + hole; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (is_hole(i) && is_hole(j)) continue;
      const std::uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

TEST(SurfaceEditor, KeepsTheBoundaryLoopsOfAnOpenSurface) {
  const TriMesh sheet = holed_sheet(24, 8);
  EXPECT_THROW(SurfaceEditor{sheet}, InputError);
  SurfaceEditor s(sheet, SurfaceEditor::Boundary::kept);
  EXPECT_EQ(s.triangles(), sheet.triangles.size());
  EXPECT_EQ(s.mesh().triangles, sheet.triangles);
  simplify(s, {.triangles = 200});
  EXPECT_NEAR(static_cast<double>(s.triangles()), 200, 1);
  flip_to_larger_angles(s, 30);
  improve_smallest_angle(s, 20, 8);
  const TriMesh light = s.mesh();
  EXPECT_EQ(light.triangles.size(), s.triangles());
  EXPECT_EQ(topology(light).euler, 0) << "a sheet with one hole";
  EXPECT_EQ(topology(light).components, 1);
  const SurfaceCheck checked = check_surface(light);
  EXPECT_TRUE(checked.manifold && checked.oriented && !checked.closed);
  EXPECT_EQ(checked.self_intersections + checked.flat_triangles, 0u);
  EXPECT_NEAR(area_mm2(light), area_mm2(sheet), 0.01 * area_mm2(sheet)) << "the boundary stays where it is";
  EXPECT_NO_THROW(SurfaceEditor(light, SurfaceEditor::Boundary::kept));
}

// Between two neighbours that stand close together on a straight boundary a needle stands on it.
TEST(ImproveSmallestAngle, SlidesVerticesAlongAStraightBoundary) {
  TriMesh sheet = holed_sheet(12, 0);
  for (Vec3& p : sheet.vertices) p[2] = 0;
  const auto crowded = std::find(sheet.vertices.begin(), sheet.vertices.end(), Vec3(6, 0, 0));
  ASSERT_NE(crowded, sheet.vertices.end());
  (*crowded)[0] = 5.1;
  SurfaceEditor s(sheet, SurfaceEditor::Boundary::kept);
  EXPECT_GT(improve_smallest_angle(s, 25, 8), 25);
  const TriMesh better = s.mesh();
  EXPECT_NEAR(area_mm2(better), 144, 1e-9) << "the outline of the square";
  for (std::uint32_t v = 0; v < s.vertex_slots(); ++v)
    if (s.has_vertex(v) && s.is_on_boundary(v)) {
      const Vec3& p = s.position(v);
      EXPECT_LT(std::min({p[0], p[1], 12 - p[0], 12 - p[1]}), 1e-12);
    }
}

TEST(SurfaceEditor, RefusesTwoLoopsThatTouchInAVertex) {
  TriMesh pinched{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_THROW(SurfaceEditor(pinched, SurfaceEditor::Boundary::kept), InputError);
}

TEST(SurfaceEditor, DoesNotCollapseATetrahedron) {
  const SurfaceEditor s(tetrahedron());
  for (std::uint32_t h = 0; h < 12; ++h) {
    EXPECT_FALSE(s.can_collapse(h));
    EXPECT_FALSE(s.can_flip(h));
  }
}

TEST(CrossingGuard, SeesWhatTheSearchForIntersectionsSees) {
  SurfaceEditor s(icosphere(3));
  CrossingGuard guard(s);
  std::mt19937 random(5);
  const auto number = [&] { return random() / 2147483648.0 - 1; };
  int crossings = 0;
  for (int n = 0; n < 300; ++n) {
    const auto v = static_cast<std::uint32_t>(random() % s.vertex_slots());
    const Vec3 before = s.position(v);
    s.position(v) += 0.5 * Vec3(number(), number(), number());
    std::vector<std::uint32_t> old;
    std::vector<SurfaceEditor::Corners> fresh;
    std::uint32_t h = s.leaving(v);
    do {
      old.push_back(h / 3);
      fresh.push_back(s.corners(h / 3));
      h = s.turned(h);
    } while (h != s.leaving(v));
    const bool crosses = guard.would_cross(fresh, old);
    EXPECT_EQ(crosses, !self_intersections(s.mesh()).free());
    crossings += crosses;
    s.position(v) = before;
  }
  EXPECT_GT(crossings, 30);
  EXPECT_LT(crossings, 270);
}

TEST(Simplify, ReachesTheCountAndKeepsASphereValidAndNear) {
  SurfaceEditor s(icosphere(5));
  EXPECT_EQ(simplify(s, {.triangles = 400}), 400u);
  const TriMesh mesh = s.mesh();
  EXPECT_TRUE(check_surface(mesh).valid());
  // 400 triangles on the unit sphere have edges of about 0.27; their middles lie (0.27 / sqrt 3)^2 / 2 below vertices
  // on it, and no vertex rises by more to make up for that.
  for (const Vec3& p : mesh.vertices) EXPECT_NEAR(p.norm(), 1, 0.0122);
  EXPECT_GT(triangle_quality(mesh).smallest_angle_deg, 20);
}

TEST(Simplify, KeepsTheEdgesOfACube) {
  SurfaceEditor s(cube_surface(20));
  simplify(s, {.triangles = 1000, .evenness = 1e-6});
  EXPECT_NEAR(volume_mm3(s.mesh()), 8, 0.01);
}

TEST(Refine, ReachesTheCountWithoutMovingTheSurface) {
  SurfaceEditor s(icosphere(1));
  const double volume = volume_mm3(s.mesh());
  refine(s, 500);
  EXPECT_EQ(s.triangles(), 500u);
  EXPECT_NEAR(volume_mm3(s.mesh()), volume, 1e-12);
  EXPECT_EQ(euler(s), 2);
}

TEST(Refine, MakesNoSliversHoweverMany) {
  // Edges that were lost from the queue stayed long while all others went on being split: half of the triangles were
  // flat in the end. Splits of the longest edge alone never fall below half of the first smallest angle.
  SurfaceEditor s(icosphere(1));
  refine(s, 4000);
  EXPECT_GT(triangle_quality(s.mesh()).smallest_angle_deg, 25);
}

TEST(RaiseSmallestAngle, MendsAShuffledBallAndKeepsItsCount) {
  std::mt19937 random(5);
  const auto number = [&] { return random() / 2147483648.0 - 1; };
  SurfaceEditor s(mapped(
      icosphere(3), [&](const Vec3& p) { return Vec3((p + 0.05 * Vec3(number(), number(), number())).normalized()); }));
  ASSERT_TRUE(self_intersections(s.mesh()).free());
  ASSERT_LT(triangle_quality(s.mesh()).smallest_angle_deg, 15);
  EXPECT_GE(improve_smallest_angle(s, 25, 10), 25);
  EXPECT_EQ(s.triangles(), 1280u);
  EXPECT_TRUE(check_surface(s.mesh()).valid());
}

TEST(Relax, EvensOutABallAndLeavesItRound) {
  std::mt19937 random(5);
  const auto number = [&] { return random() / 2147483648.0 - 1; };
  const TriMesh fine = icosphere(5);
  SurfaceEditor s(mapped(
      icosphere(3), [&](const Vec3& p) { return Vec3((p + 0.05 * Vec3(number(), number(), number())).normalized()); }));
  const double before = triangle_quality(s.mesh()).shape_mean;
  relax(s, std::vector<double>(s.vertex_slots(), 1.0), ClosestPoint(fine), fine, 5, 25);
  EXPECT_GT(triangle_quality(s.mesh()).shape_mean, before + 0.05);
  for (const Vec3& p : s.mesh().vertices) EXPECT_NEAR(p.norm(), 1, 1e-3);
}

TEST(Relax, LeavesSharpEdgesWhereTheyAre) {
  const TriMesh cube = cube_surface(6);
  const ClosestPoint on_cube(cube);
  const auto relaxed_volume = [&](double sharp_deg) {
    SurfaceEditor s(cube);
    simplify(s, {.triangles = 200, .evenness = 1e-3});
    relax(s, std::vector<double>(s.vertex_slots(), 1.0), on_cube, cube, 5, 5, sharp_deg);
    return volume_mm3(s.mesh());
  };
  EXPECT_NEAR(relaxed_volume(40), 8, 1e-3);
  EXPECT_LT(relaxed_volume(180), 7.99);
}

// A face that is cut into small triangles around a corner counts as much as one that is not.
TEST(Relax, LeavesCornersWhoseFacesAreCutUnevenly) {
  const TriMesh cube = cube_surface(6);
  const ClosestPoint on_cube(cube);
  SurfaceEditor s(cube);
  simplify(s, {.triangles = 60, .evenness = 1e-6});
  relax(s, std::vector<double>(s.vertex_slots(), 1.0), on_cube, cube, 5, 5, 60);
  improve_smallest_angle(s, 20, 4, 60);
  const TriMesh result = s.mesh();
  const ClosestPoint on_result(result);
  for (const double x : {-1, 1})
    for (const double y : {-1, 1})
      for (const double z : {-1, 1}) EXPECT_LT(on_result(Vec3(x, y, z)).distance2, 1e-6);
}

TEST(TakeBackCrossings, UndoesOnlyWhatCrosses) {
  SurfaceEditor s(icosphere(3));
  const std::vector<Vec3> safe(s.positions().begin(), s.positions().end());
  s.position(0) *= -1.5;
  s.position(100) *= 1.01;
  EXPECT_GT(revert_self_intersections(s, safe), 0u);
  EXPECT_TRUE(self_intersections(s.mesh()).free());
  EXPECT_EQ(s.position(0), safe[0]);
  EXPECT_NE(s.position(100), safe[100]);
}

}  // namespace
}  // namespace dynasurf::mesh
