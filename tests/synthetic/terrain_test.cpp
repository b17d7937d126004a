#include "dynasurf/synthetic/terrain.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/smooth.hpp"

namespace dynasurf::synthetic {
namespace {

double farthest_from_hills(const TriMesh& mesh, const Terrain& options) {
  double farthest = 0;
  for (const Vec3& p : mesh.vertices)
    farthest = std::max(farthest, std::abs(p[2] - hill_height_mm(options, p[0], p[1])));
  return farthest;
}

TEST(Terrain, IsASheetOfHillsWithSpikes) {
  const Terrain options{.cells = 30, .cell_mm = 2, .spike_mm = 6};
  const TriMesh mesh = make_terrain(options);
  EXPECT_EQ(mesh.vertices.size(), 961u);
  EXPECT_EQ(mesh.triangles.size(), 1800u);
  const mesh::Topology t = mesh::topology(mesh);
  EXPECT_EQ(t.components, 1);
  EXPECT_EQ(t.euler, 1);
  EXPECT_EQ(t.boundary_edges, 120u);
  EXPECT_TRUE(t.oriented());
  EXPECT_NEAR(farthest_from_hills(mesh, options), 6, 1e-12);
  EXPECT_EQ(farthest_from_hills(make_terrain({.cells = 30, .cell_mm = 2, .spike_every = 0}), options), 0);
  EXPECT_THROW(make_terrain({.cells = 1}), OptionError);
}

TEST(Terrain, LosesItsSpikesAndKeepsItsHillsBySmoothing) {
  // Figure 5.16.
  const Terrain options;
  TriMesh mesh = make_terrain(options);
  for (int sweep = 0; sweep < 10; ++sweep) mesh::smooth(mesh, {}, 1.0);
  EXPECT_LT(farthest_from_hills(mesh, options), 1.5);
}

}  // namespace
}  // namespace dynasurf::synthetic
