#include <algorithm>

#include <gtest/gtest.h>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/detail/voxel_truth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf {
namespace {

TriMesh outer_surface(const Image& image) {
  const Image border = external_border(image, 0.2, 35);
  return evolve(place(icosphere(3), border, {}), flow_field(border, Gvf{}).field, border, {}).mesh;
}

TEST(GapInTheWall, IsBridgedByTheSurfaceAndCutsMarchingCubesInTwo) {
  // Fig 5.8: the middle third of the phantom is missing.
  const Image gap = make_phantom(Gap{}).study.gates.front(), whole = make_phantom(Hebron{}).study.gates.front();
  const float max = *std::max_element(gap.values.begin(), gap.values.end());
  EXPECT_EQ(topology(marching_cubes(gap, 0.5 * max)).components, 2);
  EXPECT_EQ(topology(marching_cubes(whole, 0.5 * max)).components, 1);
  const TriMesh bridged = outer_surface(gap);
  EXPECT_EQ(topology(bridged).components, 1);
  const double volume = volume_mm3(outer_surface(whole));
  EXPECT_NEAR(volume_mm3(bridged), volume, 0.2 * volume);
}

}  // namespace
}  // namespace dynasurf
