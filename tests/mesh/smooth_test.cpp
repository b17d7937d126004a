#include "dynasurf/mesh/smooth.hpp"

#include <random>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"

#include "support/shapes.hpp"

namespace dynasurf::mesh {
namespace {

using namespace test_shapes;

/// The deficit as the thesis writes it: one arc cosine per triangle. Judge of the fast sum.
std::vector<double> deficits_by_arc_cosine(const TriMesh& m) {
  std::vector<double> deficit(m.vertices.size(), 2 * std::numbers::pi);
  for (const auto& t : m.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 u = (m.vertices[t[(c + 1) % 3]] - m.vertices[t[c]]).normalized();
      const Vec3 v = (m.vertices[t[(c + 2) % 3]] - m.vertices[t[c]]).normalized();
      deficit[t[c]] -= std::acos(std::clamp(u.dot(v), -1.0, 1.0));
    }
  return deficit;
}

int peaks(const TriMesh& m, double tolerance) {
  int count = 0;
  for (double d : angle_deficits(m)) count += std::abs(d) > tolerance ? 1 : 0;
  return count;
}

TriMesh noisy_sphere(double amplitude) {
  std::mt19937 random(3);
  return mapped(icosphere(3),
                [&](const Vec3& p) { return Vec3(p * (30 + amplitude * (random() / 2147483648.0 - 1))); });
}

TEST(AngleDeficits, EqualTheSumOfArcCosinesOnAllShapes) {
  auto shapes = closed_meshes();
  shapes.push_back({"very noisy sphere", noisy_sphere(12)});
  TriMesh needle = icosphere(1);
  needle.vertices[5] *= 1000;  // nearly nothing is left of the angle at its tip
  shapes.push_back({"needle", needle});
  for (const auto& [name, m] : shapes) {
    const auto fast = angle_deficits(m), slow = deficits_by_arc_cosine(m);
    // The arc cosine loses half its digits near 0 and pi: 1e-7 is all the judge can promise.
    for (std::size_t v = 0; v < fast.size(); ++v) EXPECT_NEAR(fast[v], slow[v], 1e-7) << name << " vertex " << v;
  }
}

TEST(AngleDeficits, SumToTheEulerCharacteristic) {
  for (const auto& [name, m] : closed_meshes()) {
    double sum = 0;
    for (double d : angle_deficits(m)) sum += d;
    EXPECT_NEAR(sum, 2 * std::numbers::pi * static_cast<double>(topology(m).euler), 1e-9) << name;
  }
}

TEST(AngleDeficits, CountSaddlesOfManyTurnsAndTakeNoRimForAPeak) {
  // A pleated fan: 24 folds around a vertex, sum of angles far beyond two full turns.
  TriMesh fan{{{0, 0, 0}}, {}};
  for (int n = 0; n < 48; ++n) {
    const double a = 2 * std::numbers::pi * n / 48;
    fan.vertices.emplace_back(std::cos(a), std::sin(a), n % 2 ? 2 : -2);
  }
  for (std::uint32_t n = 0; n < 48; ++n) fan.triangles.push_back({0, 1 + n, 1 + (n + 1) % 48});
  EXPECT_NEAR(angle_deficits(fan)[0], deficits_by_arc_cosine(fan)[0], 1e-7);
  EXPECT_LT(angle_deficits(fan)[0], -8 * std::numbers::pi);
  EXPECT_EQ(angle_deficits(fan)[1], 0);
  for (double d : angle_deficits(sheet(3))) EXPECT_NEAR(d, 0, 1e-12);
}

TEST(VertexRings, HoldEveryNeighbourOnceInTheOrderOfTheFan) {
  for (const auto& [name, m] : closed_meshes()) {
    const VertexRings rings = vertex_rings(m);
    std::size_t pairs = 0;
    for (std::uint32_t v = 0; v < m.vertices.size(); ++v) {
      const auto ring = rings.of(v);
      EXPECT_GE(ring.size(), 3U) << name;
      for (std::size_t n = 0; n < ring.size(); ++n) {
        const std::array<std::uint32_t, 3> wanted{v, ring[n], ring[(n + 1) % ring.size()]};
        pairs += static_cast<std::size_t>(std::count_if(m.triangles.begin(), m.triangles.end(), [&](const auto& t) {
          for (std::size_t c = 0; c < 3; ++c)
            if (t[c] == wanted[0] && t[(c + 1) % 3] == wanted[1] && t[(c + 2) % 3] == wanted[2]) return true;
          return false;
        }));
      }
      if (m.vertices.size() > 200) break;  // the search through all triangles is for small meshes
    }
    if (m.vertices.size() <= 200) {
      EXPECT_EQ(pairs, 3 * m.triangles.size()) << name;
    }
  }
}

TEST(VertexRings, AreEmptyOnTheRimAndWhereFansMeet) {
  const TriMesh m = sheet(2);
  const VertexRings rings = vertex_rings(m);
  for (std::uint32_t v = 0; v < 9; ++v) EXPECT_EQ(rings.of(v).size(), v == 4 ? 6U : 0U);
  TriMesh two = tetrahedron();  // two tetrahedra that share vertex 0
  two.vertices.insert(two.vertices.end(), {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
  for (auto t : tetrahedron().triangles) {
    for (auto& v : t) v = v == 0 ? 0 : v + 3;
    two.triangles.push_back(t);
  }
  EXPECT_TRUE(vertex_rings(two).of(0).empty());
  EXPECT_EQ(vertex_rings(two).of(1).size(), 3U);
}

TEST(Smooth, LeavesAnIcosphereAlone) {
  for (int level = 2; level <= 4; ++level) {
    TriMesh m = icosphere(level);
    EXPECT_EQ(smooth(m, {.tolerance_rad = 0.2, .sweeps = 10}, 0.1).moved, 0);
    EXPECT_EQ(m.vertices, icosphere(level).vertices);
  }
}

TEST(Smooth, RemovesAPlantedSpikeFromASheetAndASphere) {
  for (const bool literal : {false, true}) {
    TriMesh flat = sheet(8);
    flat.vertices[40][2] = 3;
    smooth(flat, {.literal_step = literal, .sweeps = 40}, 2.87);
    EXPECT_EQ(peaks(flat, 0.2), 0);
    EXPECT_LT(flat.vertices[40][2], 1);

    TriMesh round = ellipsoid(3, {30, 30, 30});
    round.vertices[100] *= 1.5;
    const double planted = round.vertices[100].norm();
    smooth(round, {.literal_step = literal, .sweeps = 40}, 2.87);
    EXPECT_EQ(peaks(round, 0.2), 0);
    EXPECT_LT(round.vertices[100].norm(), 30 + 0.25 * (planted - 30));
  }
}

TEST(Smooth, TakesANeedleForAPeakThoughItsAnglesSumToNearlyNothing) {
  // A sum near 0 points in the same direction as a full turn.
  TriMesh m = icosphere(1);
  m.vertices[5] *= 1000;
  ASSERT_GT(angle_deficits(m)[5], 6.2);
  std::vector<std::uint8_t> pinned(m.vertices.size(), 1);
  pinned[5] = 0;
  EXPECT_EQ(smooth(m, {}, 20, pinned).moved, 1);
  EXPECT_LT(m.vertices[5].norm(), 10);
}

TEST(Smooth, LowersTheNumberOfPeaksAndKeepsVolumeAndTopology) {
  TriMesh m = noisy_sphere(1.2);
  const double volume = volume_mm3(m);
  const auto triangles = m.triangles;
  const int before = peaks(m, 0.2);
  ASSERT_GT(before, 50);
  smooth(m, {}, 2.87);
  const int once = peaks(m, 0.2);
  EXPECT_LT(once, before);
  smooth(m, {.sweeps = 20}, 2.87);
  EXPECT_LT(peaks(m, 0.2), once / 2);
  EXPECT_NEAR(volume_mm3(m) / volume, 1, 0.01);
  EXPECT_EQ(m.triangles, triangles);
}

TEST(Smooth, LowersTheSpikesOfATerrain) {
  // Thesis fig. 5.16: a height field with spikes.
  TriMesh m = sheet(24);
  std::mt19937 random(11);
  for (Vec3& p : m.vertices) p[2] = std::sin(p[0] / 4) * std::cos(p[1] / 5) + (random() % 20 == 0 ? 3 : 0);
  const int before = peaks(m, 0.2);
  smooth(m, {.sweeps = 60}, 1);
  EXPECT_LT(peaks(m, 0.2), before / 4);
}

TEST(Smooth, MovesALengthOrAShareOfTheWay) {
  // One step is enough at this tolerance, so the step itself is seen.
  const auto height_after_one_step = [](bool literal) {
    TriMesh m = sheet(8);
    m.vertices[40][2] = 2;
    const auto deficit = angle_deficits(m)[40];
    smooth(m, {.tolerance_rad = deficit - 1e-6, .step_mm = 0.1, .literal_step = literal}, 2.87, [] {
      std::vector<std::uint8_t> all(81, 1);
      return all[40] = 0, all;
    }());
    return m.vertices[40][2];
  };
  EXPECT_NEAR(height_after_one_step(false), 1.9, 1e-12);  // 0.1 mm
  EXPECT_NEAR(height_after_one_step(true), 1.8, 1e-12);   // a tenth of 2 mm
}

TEST(Smooth, ReportsAPeakThatIsStillThereInTheCentroid) {
  TriMesh m = tetrahedron();
  const SmoothReport report = smooth(m, {}, 1, {0, 1, 1, 1});
  EXPECT_EQ(report.moved, 1);
  EXPECT_EQ(report.at_centroid, 0);  // the centroid of three neighbours is flat
  // A ring of folds has a saddle in its centroid and all around it.
  TriMesh folded{{{0.3, 0, 0}}, {}};
  for (int n = 0; n < 8; ++n) {
    const double a = std::numbers::pi * n / 4;
    folded.vertices.emplace_back(std::cos(a), std::sin(a), n % 2 ? 1.5 : -1.5);
  }
  for (std::uint32_t n = 0; n < 8; ++n) folded.triangles.push_back({0, 1 + n, 1 + (n + 1) % 8});
  EXPECT_EQ(smooth(folded, {}, 1).at_centroid, 1);
  EXPECT_LT(folded.vertices[0].norm(), 1e-12);
}

TEST(Smooth, KeepsPinnedAndRimVertices) {
  TriMesh m = sheet(4);
  m.vertices[12][2] = m.vertices[0][2] = 4;
  const TriMesh before = m;
  std::vector<std::uint8_t> pinned(25, 0);
  pinned[12] = 1;
  smooth(m, {.sweeps = 3}, 1, pinned);
  EXPECT_EQ(m.vertices[12], before.vertices[12]);
  for (std::size_t v : {0U, 4U, 10U, 20U, 24U}) EXPECT_EQ(m.vertices[v], before.vertices[v]);
}

TEST(Smooth, StaysFiniteOnCollapsedTrianglesAndEndsOnTinySteps) {
  TriMesh m = ellipsoid(2, {1, 1, 1});
  for (std::size_t v = 0; v < 30; ++v) m.vertices[v] = m.vertices[0];
  smooth(m, {.tolerance_rad = 0, .step_mm = 1e-12, .sweeps = 1}, 1);
  for (const Vec3& p : m.vertices) EXPECT_TRUE(p.allFinite());
}

TEST(Smooth, RefusesOptionsOutOfRange) {
  TriMesh m = sheet(2);
  EXPECT_THROW(smooth(m, {.tolerance_rad = -1}, 1), OptionError);
  EXPECT_THROW(smooth(m, {.sweeps = -1}, 1), OptionError);
}

}  // namespace
}  // namespace dynasurf::mesh
