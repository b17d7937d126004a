#include "dynasurf/cloud/reconstruct_cloud.hpp"

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf {
namespace {

PointCloud ball() {
  PointCloud cloud{icosphere(5).vertices, {}, {}, {}};
  for (Vec3& p : cloud.points) p = Vec3(7, -3, 100) + 0.02 * p;
  return cloud;
}

TEST(CloudOptions, ListsOfTrianglesAreReadStrictly) {
  EXPECT_EQ(parse_triangles("5120,1280,320"), (std::vector<int>{5120, 1280, 320}));
  EXPECT_EQ(parse_triangles("20"), (std::vector<int>{20}));
  for (const char* bad : {"", ",", "320,", "320,1280", "321", "18", "320 ,20", "320,320", "2000002", "-320", "1e3"})
    EXPECT_THROW(parse_triangles(bad), OptionError) << bad;
}

TEST(CloudOptions, PresetsAreNamedAsTheirMethods) {
  EXPECT_EQ(cloud_preset("shaped").method, CloudMethod::shaped);
  EXPECT_EQ(cloud_preset("thesis").method, CloudMethod::thesis);
  EXPECT_THROW(cloud_preset("best"), OptionError);
}

TEST(ReconstructCloud, TheThesisRecipeWrapsASphereWithinAVoxel) {
  CloudOptions options = cloud_preset("thesis");
  options.triangles = "1280,320";
  const CloudResult result = reconstruct_cloud(ball(), options);
  ASSERT_EQ(result.levels.size(), 2u);
  for (const CloudLevel& level : result.levels) {
    EXPECT_EQ(level.mesh.triangles.size(), static_cast<std::size_t>(level.triangles_asked));
    EXPECT_TRUE(level.certificate.closed && level.certificate.manifold && level.certificate.oriented);
    // Particles stop where they enter the voxel of a point: sides are 1/54 of the diameter.
    EXPECT_LT(level.certificate.cloud_to_mesh_mean, 1.5 * 0.04 / 54);
  }
}

TEST(ReconstructCloud, TheThesisRecipeMakesIcospheresOnly) {
  CloudOptions options = cloud_preset("thesis");
  options.triangles = "1000";
  EXPECT_THROW(reconstruct_cloud(ball(), options), OptionError);
}

}  // namespace
}  // namespace dynasurf
