#include "dynasurf/mesh/detail/submesh.hpp"

#include <gtest/gtest.h>

namespace dynasurf::mesh {
namespace {

TEST(Submesh, NumbersTheVerticesInUseAsTheTrianglesNameThem) {
  TriMesh strip;
  for (int i = 0; i < 5; ++i) strip.vertices.push_back(Vec3(i, i % 2, 0));
  strip.triangles = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}};
  const TriMesh last = submesh(strip, std::vector<std::uint8_t>{0, 0, 1});
  ASSERT_EQ(last.vertices.size(), 3u);
  EXPECT_EQ(last.triangles, (decltype(last.triangles){{0, 1, 2}}));
  EXPECT_EQ(last.vertices[0], strip.vertices[2]);
  EXPECT_EQ(last.vertices[2], strip.vertices[4]);
  EXPECT_TRUE(submesh(strip, std::vector<std::uint8_t>{0, 0, 0}).vertices.empty());
}

}  // namespace
}  // namespace dynasurf::mesh
