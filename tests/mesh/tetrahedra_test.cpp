#include "dynasurf/mesh/tetrahedra.hpp"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

TriMesh scaled(TriMesh mesh, const Vec3& factors, const Vec3& shift = Vec3::Zero()) {
  for (Vec3& p : mesh.vertices) p = p.cwiseProduct(factors) + shift;
  return mesh;
}

/// A thick shell: some hundred tetrahedra of uneven shape.
TetMesh shell() {
  return fill_between(scaled(icosphere(1), {10, 12, 14}), scaled(icosphere(1), {16, 17, 19}, {1, 0, 0}), 2);
}

bool on_surface(const TetMesh& solid, std::uint32_t v) {
  const std::size_t layer = icosphere(1).vertices.size();
  return v < layer || v >= solid.vertices.size() - layer;
}

TEST(FillBetween, AddsUpToOuterLessInner) {
  const TriMesh inner = scaled(icosphere(3), {20, 22, 40}, {1, 2, 3}), outer = scaled(icosphere(3), {30, 31, 50});
  for (const int layers : {1, 3}) {
    const TetMesh solid = fill_between(inner, outer, layers);
    EXPECT_EQ(solid.tetrahedra.size(), 3 * inner.triangles.size() * static_cast<std::size_t>(layers));
    const double wall = volume_mm3(outer) - volume_mm3(inner);
    EXPECT_NEAR(volume_mm3(solid), wall, 1e-9 * wall);
    const TetQuality q = tet_quality(solid);
    EXPECT_EQ(q.not_positive, 0u);
    EXPECT_NEAR(q.volume_mean * static_cast<double>(q.count), wall, 1e-9 * wall);
    EXPECT_GT(q.shape_min, 0.1);
  }
}

TEST(FillBetween, CutsTheSidesOfNeighboursAlike) {
  // Every inner face belongs to two tetrahedra that see it from opposite sides; what is left is the two surfaces.
  const TetMesh solid = shell();
  std::map<std::array<std::uint32_t, 3>, int> faces;
  for (const auto& t : solid.tetrahedra)
    for (const auto& f : {std::array{t[0], t[2], t[1]}, {t[0], t[1], t[3]}, {t[1], t[2], t[3]}, {t[2], t[0], t[3]}}) {
      std::array<std::uint32_t, 3> key = f;
      const bool is_odd = (f[0] > f[1]) != ((f[1] > f[2]) != (f[0] > f[2]));
      std::sort(key.begin(), key.end());
      faces[key] += is_odd ? -1 : 1;
    }
  std::size_t open = 0;
  for (const auto& [face, sum] : faces) open += sum != 0;
  EXPECT_EQ(open, 2 * icosphere(1).triangles.size());
}

TEST(FillBetween, CountsWhatSurfacesThatCrossTurnInsideOut) {
  const TetMesh solid = fill_between(scaled(icosphere(2), {10, 10, 10}, {4, 0, 0}), scaled(icosphere(2), {12, 12, 12}));
  EXPECT_GT(tet_quality(solid).not_positive, 0u);
}

TEST(FillBetween, RefusesDifferentTriangles) {
  EXPECT_THROW(fill_between(icosphere(1), icosphere(2)), InputError);
  EXPECT_THROW(fill_between(icosphere(1), scaled(icosphere(1), {2, 2, 2}), 0), InputError);
}

TEST(TetQuality, OfARegularTetrahedronIsOne) {
  const TetMesh regular{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 3, 2}}};
  const TetQuality q = tet_quality(regular);
  ASSERT_EQ(q.not_positive, 0u);
  EXPECT_NEAR(q.shape_min, 1, 1e-12);
  EXPECT_NEAR(q.volume_min, 8.0 / 3, 1e-12);
}

TEST(ElasticSolid, PassesThePatchTest) {
  // What a linear displacement does on the surface it does inside: constant strain is met exactly.
  const TetMesh solid = shell();
  Mat3 strain;
  strain << 0.01, 0.004, -0.002, 0.003, -0.02, 0.005, 0.001, -0.003, 0.015;
  const Vec3 shift(0.3, -0.1, 0.2);
  std::vector<HeldVertex> held;
  for (std::uint32_t v = 0; v < solid.vertices.size(); ++v)
    if (on_surface(solid, v)) held.push_back({v, strain * solid.vertices[v] + shift});
  const auto moved = solve_elastic(solid, {1, 0.3}, held, {});
  for (std::uint32_t v = 0; v < solid.vertices.size(); ++v)
    EXPECT_LT((moved[v] - strain * solid.vertices[v] - shift).norm(), 1e-10) << v;
}

TEST(ElasticSolid, StretchesABarByHookesLaw) {
  // Pulled at both ends with free sides: strain = stress / E, and -nu of it across.
  TetMesh bar;  // a cube of six tetrahedra around its diagonal
  bar.vertices = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}, {0, 0, 10}, {10, 0, 10}, {10, 10, 10}, {0, 10, 10}};
  bar.tetrahedra = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  ASSERT_EQ(tet_quality(bar).not_positive, 0u);
  ASSERT_NEAR(volume_mm3(bar), 1000, 1e-9);
  // A stress of 0.1 MPa along x on faces of 100 mm2; a third of each triangle's load on its corners.
  const double stress = 0.1, young = 2, poisson = 0.3;
  std::vector<VertexForce> forces;
  for (const auto& [corner, share] : {std::pair(1, 1.0 / 3), {2, 1.0 / 6}, {5, 1.0 / 6}, {6, 1.0 / 3}})
    forces.push_back({static_cast<std::uint32_t>(corner), {stress * 100 * share, 0, 0}});
  for (const auto& [corner, share] : {std::pair(0, 1.0 / 3), {3, 1.0 / 6}, {4, 1.0 / 6}, {7, 1.0 / 3}})
    forces.push_back({static_cast<std::uint32_t>(corner), {-stress * 100 * share, 0, 0}});
  const auto exact = [&](const Vec3& p) {
    return Vec3(stress / young * p[0], -poisson * stress / young * p[1], -poisson * stress / young * p[2]);
  };
  std::vector<HeldVertex> held;
  for (const std::uint32_t v : {0u, 1u, 3u}) held.push_back({v, exact(bar.vertices[v])});
  const auto moved = solve_elastic(bar, {young, poisson}, held, forces);
  for (std::size_t v = 0; v < bar.vertices.size(); ++v)
    EXPECT_LT((moved[v] - exact(bar.vertices[v])).norm(), 1e-10) << v;
}

TEST(ElasticSolid, AnswersAForceAsItWouldBeAnswered) {
  // Maxwell and Betti: the displacement at b along e by a force at a along d is that at a along d by one at b along e.
  const TetMesh solid = shell();
  const std::vector<HeldVertex> held{{0, Vec3::Zero()}, {1, Vec3::Zero()}, {2, Vec3::Zero()}, {3, Vec3::Zero()}};
  const std::uint32_t a = 60, b = 110;
  const Vec3 d(1, 2, -1), e(0.5, -1, 3);
  const std::vector<VertexForce> at_a{{a, d}}, at_b{{b, e}};
  const double one = solve_elastic(solid, {0.02, 0.45}, held, at_a)[b].dot(e);
  const double other = solve_elastic(solid, {0.02, 0.45}, held, at_b)[a].dot(d);
  EXPECT_NEAR(one, other, 1e-8 * std::abs(one));
  EXPECT_GT(solve_elastic(solid, {0.02, 0.45}, held, at_a)[a].dot(d), 0);  // and gives way
}

/// How often each face occurs; in a solid without gaps once on its surface and twice inside.
std::map<std::array<std::uint32_t, 3>, int> faces_of(const TetMesh& solid) {
  std::map<std::array<std::uint32_t, 3>, int> faces;
  for (const auto& t : solid.tetrahedra)
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<std::uint32_t, 3> face{};
      for (std::size_t c = 0, n = 0; c < 4; ++c)
        if (c != left_out) face[n++] = t[c];
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  return faces;
}

double area_of_surface(const TetMesh& solid) {
  double area = 0;
  for (const auto& [f, count] : faces_of(solid)) {
    EXPECT_LE(count, 2);
    const Vec3 &a = solid.vertices[f[0]], &b = solid.vertices[f[1]], &c = solid.vertices[f[2]];
    if (count == 1) area += (b - a).cross(c - a).norm() / 2;
  }
  return area;
}

TEST(Refined, KeepsTheSolidWithoutGapsAndIsFinerOnlyThere) {
  const TetMesh coarse = shell();
  TetMesh solid = coarse;
  const Vec3 place = solid.vertices[60];
  for (int round = 0; round < 4; ++round) {
    std::vector<std::uint32_t> marked;
    for (std::uint32_t n = 0; n < solid.tetrahedra.size(); ++n)
      for (const std::uint32_t v : solid.tetrahedra[n])
        if (solid.vertices[v] == place) marked.push_back(n);
    solid = refined(solid, marked);
    EXPECT_EQ(tet_quality(solid).not_positive, 0u);
    EXPECT_NEAR(volume_mm3(solid) / volume_mm3(coarse), 1, 1e-12);
    // Were an edge cut on one side of a face only, faces would be left without a partner inside, and add area.
    EXPECT_NEAR(area_of_surface(solid) / area_of_surface(coarse), 1, 1e-12);
  }
  EXPECT_GT(solid.tetrahedra.size(), coarse.tetrahedra.size());
  EXPECT_LT(solid.tetrahedra.size(), 5 * coarse.tetrahedra.size());
  for (std::uint32_t v = 0; v < coarse.vertices.size(); ++v) EXPECT_EQ(solid.vertices[v], coarse.vertices[v]);
  const auto smallest = [](const TetMesh& mesh, const Vec3& p) {
    double least = 1e300;
    for (const auto& t : mesh.tetrahedra)
      for (const std::uint32_t v : t)
        if (mesh.vertices[v] == p)
          for (const std::uint32_t w : t)
            if (w != v) least = std::min(least, (mesh.vertices[w] - p).norm());
    return least;
  };
  EXPECT_LT(smallest(solid, place), 0.6 * smallest(coarse, place));
  EXPECT_TRUE(tet_quality(solid).shape_min > 0.2 * tet_quality(coarse).shape_min);
  const std::vector<std::uint32_t> beyond{100000};
  EXPECT_THROW(refined(coarse, beyond), InputError);
  EXPECT_EQ(refined(coarse, {}).tetrahedra, coarse.tetrahedra);
}

TEST(Refined, GivesWayMoreWhereAForceActs) {
  // Energy falls with every finer space of functions: the point that is pressed gives way more, never less.
  TetMesh solid = shell();
  const std::vector<HeldVertex> held{{0, Vec3::Zero()}, {1, Vec3::Zero()}, {2, Vec3::Zero()}, {3, Vec3::Zero()}};
  const std::vector<VertexForce> force{{60, {0.1, 0.2, -0.1}}};
  double before = solve_elastic(solid, {}, held, force)[60].dot(force[0].force);
  for (int round = 0; round < 3; ++round) {
    std::vector<std::uint32_t> marked;
    for (std::uint32_t n = 0; n < solid.tetrahedra.size(); ++n)
      if (std::find(solid.tetrahedra[n].begin(), solid.tetrahedra[n].end(), 60u) != solid.tetrahedra[n].end())
        marked.push_back(n);
    solid = refined(solid, marked);
    const double now = solve_elastic(solid, {}, held, force)[60].dot(force[0].force);
    EXPECT_GT(now, before);
    before = now;
  }
}

TEST(Carried, MovesPlacesLinearlyWithTheCageAndBeyondIt) {
  const TetMesh cage = shell();
  Mat3 strain;
  strain << 0.01, 0.004, -0.002, 0.003, -0.02, 0.005, 0.001, -0.003, 0.015;
  std::vector<Vec3> moved, places;
  for (const Vec3& p : cage.vertices) moved.push_back(strain * p + Vec3(1, 2, 3)), places.push_back(1.02 * p);
  for (const auto& t : cage.tetrahedra)
    places.push_back((cage.vertices[t[0]] + cage.vertices[t[1]] + cage.vertices[t[2]] + cage.vertices[t[3]]) / 4);
  const std::vector<Vec3> found = carried(cage, moved, places);
  for (std::size_t n = 0; n < places.size(); ++n)
    EXPECT_LT((found[n] - strain * places[n] - Vec3(1, 2, 3)).norm(), 1e-9) << n;
  // A vertex of the cage goes with it, whatever the others do.
  moved.assign(moved.size(), Vec3::Zero());
  moved[60] = Vec3(0, 0, 5);
  const std::vector<Vec3> one{cage.vertices[60], cage.vertices[61]};
  EXPECT_LT((carried(cage, moved, one)[0] - moved[60]).norm(), 1e-9);
  EXPECT_LT(carried(cage, moved, one)[1].norm(), 1e-9);
  EXPECT_THROW(carried(cage, std::vector<Vec3>(3), places), InputError);
  EXPECT_THROW(carried({}, {}, places), InputError);
}

TEST(ElasticSolid, RefusesWhatHasNoAnswer) {
  const TetMesh solid = shell();
  EXPECT_THROW(solve_elastic(solid, {0, 0.3}, {}, {}), InputError);
  EXPECT_THROW(solve_elastic(solid, {1, 0.5}, {}, {}), InputError);
  const std::vector<HeldVertex> twice{{1, Vec3::Zero()}, {1, Vec3::Zero()}}, beyond{{100000, Vec3::Zero()}};
  EXPECT_THROW(solve_elastic(solid, {1, 0.3}, twice, {}), InputError);
  EXPECT_THROW(solve_elastic(solid, {1, 0.3}, beyond, {}), InputError);
  TetMesh inside_out = solid;
  std::swap(inside_out.tetrahedra[5][0], inside_out.tetrahedra[5][1]);
  EXPECT_THROW(solve_elastic(inside_out, {1, 0.3}, {}, {}), InputError);
}

}  // namespace
}  // namespace dynasurf::mesh
