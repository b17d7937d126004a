#include <algorithm>

#include <gtest/gtest.h>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/detail/voxel_truth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::ventricle {
namespace {

TriMesh outer_surface(const Image& image) {
  const Image border = synthetic::external_border(image, 0.2, 35);
  return dynamics::evolve(mesh::place(mesh::icosphere(3), border, {}), field::flow_field(border, field::Gvf{}).field,
                          border, {})
      .mesh;
}

TEST(GapInTheWall, IsBridgedByTheSurfaceAndCutsMarchingCubesInTwo) {
  // Fig 5.8: the middle third of the phantom is missing.
  const Image gap = synthetic::make_phantom(synthetic::Gap{}).study.gates.front(),
              whole = synthetic::make_phantom(synthetic::Hebron{}).study.gates.front();
  const float max = *std::max_element(gap.values.begin(), gap.values.end());
  EXPECT_EQ(mesh::topology(mesh::marching_cubes(gap, 0.5 * max)).components, 2);
  EXPECT_EQ(mesh::topology(mesh::marching_cubes(whole, 0.5 * max)).components, 1);
  const TriMesh bridged = outer_surface(gap);
  EXPECT_EQ(mesh::topology(bridged).components, 1);
  const double volume = mesh::volume_mm3(outer_surface(whole));
  EXPECT_NEAR(mesh::volume_mm3(bridged), volume, 0.2 * volume);
}

}  // namespace
}  // namespace dynasurf::ventricle
