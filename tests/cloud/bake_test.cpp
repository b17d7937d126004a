#include "dynasurf/cloud/detail/bake.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/sample_surface.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::cloud {
namespace {

/// A direction that no coarse mesh has by itself: ripples over the sphere.
Vec3 rippled(const Vec3& p) {
  return (p + 0.4 * Vec3(std::sin(8 * p[1]), std::sin(8 * p[2]), std::sin(8 * p[0]))).normalized();
}

PointCloud ripples(std::size_t count) {
  PointCloud cloud;
  const TriMesh fine = mesh::icosphere(5);
  for (const mesh::SurfaceSample& s : mesh::sample_surface(fine, count)) {
    const Vec3 p = mesh::position_of(fine, s).normalized();
    cloud.points.push_back(p);
    cloud.normals.push_back(3 * rippled(p));  // any length
    cloud.colours.push_back({static_cast<std::uint8_t>(std::lround(100 + 90 * p[0])), 50, 200});
  }
  return cloud;
}

/// What a viewer shows at a place of a triangle, as glTF says it: the texel, turned by the interpolated frame.
Vec3 shown(const mesh::TexturedMesh& mesh, std::size_t triangle, const Vec3& weight) {
  Eigen::Vector2f uv(0, 0);
  Vec3 normal(0, 0, 0), tangent(0, 0, 0);
  for (std::size_t i = 0; i < 3; ++i) {
    const mesh::TexturedMesh::Corner& c = mesh.corners[3 * triangle + i];
    const double w = weight[static_cast<Eigen::Index>(i)];
    uv += static_cast<float>(w) * c.uv;
    normal += w * c.normal.cast<double>();
    tangent += w * c.tangent.cast<double>();
  }
  normal.normalize();
  tangent = (tangent - normal * normal.dot(tangent)).normalized();
  const auto x = static_cast<std::size_t>(uv[0] * static_cast<float>(mesh.normals.width));
  const auto y = static_cast<std::size_t>(uv[1] * static_cast<float>(mesh.normals.height));
  const auto& texel = mesh.normals.texels[y * static_cast<std::size_t>(mesh.normals.width) + x];
  const Vec3 v = Vec3(texel[0], texel[1], texel[2]) / 127.5 - Vec3::Ones();
  return (v[0] * tangent + v[1] * normal.cross(tangent) + v[2] * normal).normalized();
}

TEST(BakeTextures, ShowTheDirectionsOfThePointsOnACoarseMesh) {
  const TriMesh coarse = mesh::icosphere(2);
  const mesh::TexturedMesh baked = bake_textures(coarse, ripples(60000));
  double worst = 1, plain_worst = 1, mean = 0;
  std::size_t count = 0;
  for (std::size_t t = 0; t < coarse.triangles.size(); ++t)
    for (const Vec3& w : {Vec3(0.33, 0.33, 0.34), Vec3(0.8, 0.1, 0.1), Vec3(0.1, 0.45, 0.45)}) {
      Vec3 place(0, 0, 0);
      for (std::size_t i = 0; i < 3; ++i)
        place += w[static_cast<Eigen::Index>(i)] * coarse.vertices[coarse.triangles[t][i]];
      const Vec3 truth = rippled(place.normalized());
      const double agreement = shown(baked, t, w).dot(truth);
      worst = std::min(worst, agreement);
      mean += agreement;
      ++count;
      plain_worst = std::min(plain_worst, place.normalized().dot(truth));
    }
  // The ripples turn by 0.4 * 8 = 3.2 radians per unit and six points are 0.03 wide: 6 degrees; a texel adds as much.
  EXPECT_GT(worst, std::cos(14 * 3.14159 / 180));
  EXPECT_GT(mean / static_cast<double>(count), std::cos(4 * 3.14159 / 180));
  EXPECT_LT(plain_worst, std::cos(30 * 3.14159 / 180)) << "without the map the mesh shows none of it";
}

TEST(BakeTextures, GiveEveryTriangleAPlaceOfItsOwn) {
  const TriMesh mesh = mesh::icosphere(1);
  const mesh::TexturedMesh baked = bake_textures(mesh, ripples(5000));
  ASSERT_EQ(baked.corners.size(), 3 * mesh.triangles.size());
  double area = 0;
  std::map<std::pair<int, int>, std::size_t> owner;  // of the texels that a triangle shows
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto &a = baked.corners[3 * t].uv, &b = baked.corners[3 * t + 1].uv, &c = baked.corners[3 * t + 2].uv;
    for (const auto& uv : {a, b, c}) {
      EXPECT_GT(uv.minCoeff(), 0);
      EXPECT_LT(uv.maxCoeff(), 1);
    }
    const double twice = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0];
    EXPECT_GT(twice, 0) << "none is mirrored, or its bitangent would be wrong";
    area += twice / 2;
    for (float u = 0; u <= 1; u += 0.05F)
      for (float v = 0; u + v <= 1; v += 0.05F) {
        const Eigen::Vector2f uv = a + u * (b - a) + v * (c - a);
        const std::pair texel(static_cast<int>(uv[0] * static_cast<float>(baked.normals.width)),
                              static_cast<int>(uv[1] * static_cast<float>(baked.normals.height)));
        EXPECT_EQ(owner.try_emplace(texel, t).first->second, t);
      }
    for (std::size_t i = 0; i < 3; ++i) {
      const mesh::TexturedMesh::Corner& corner = baked.corners[3 * t + i];
      EXPECT_EQ(corner.position, mesh.vertices[mesh.triangles[t][i]]);
      EXPECT_NEAR(corner.tangent.norm(), 1, 1e-6);
      EXPECT_NEAR(corner.tangent.dot(corner.normal), 0, 1e-6);
    }
  }
  EXPECT_GT(area, 0.4) << "room is not wasted";
  EXPECT_LT(area, 1);
}

TEST(BakeTextures, CarryTheColours) {
  const TriMesh coarse = mesh::icosphere(2);
  const PointCloud cloud = ripples(60000);
  const mesh::TexturedMesh baked = bake_textures(coarse, cloud);
  ASSERT_EQ(baked.colours.texels.size(), baked.normals.texels.size());
  for (std::size_t t = 0; t < coarse.triangles.size(); t += 7) {
    Eigen::Vector2f uv(0, 0);
    Vec3 place(0, 0, 0);
    for (std::size_t i = 0; i < 3; ++i) {
      uv += baked.corners[3 * t + i].uv / 3;
      place += baked.corners[3 * t + i].position / 3;
    }
    const auto x = static_cast<std::size_t>(uv[0] * static_cast<float>(baked.colours.width));
    const auto y = static_cast<std::size_t>(uv[1] * static_cast<float>(baked.colours.height));
    const auto& colour = baked.colours.texels[y * static_cast<std::size_t>(baked.colours.width) + x];
    EXPECT_NEAR(colour[0], 100 + 90 * place.normalized()[0], 4);
    EXPECT_EQ(colour[1], 50);
    EXPECT_EQ(colour[2], 200);
  }
  PointCloud plain = cloud;
  plain.colours.clear();
  EXPECT_TRUE(bake_textures(coarse, plain).colours.texels.empty());
}

TEST(BakeTextures, AreTheSameForAnyNumberOfThreads) {
  const TriMesh mesh = mesh::icosphere(2);
  const PointCloud cloud = ripples(5000);
  const mesh::TexturedMesh many = bake_textures(mesh, cloud);
  const ThreadLimit one(1);
  EXPECT_EQ(bake_textures(mesh, cloud).normals.texels, many.normals.texels);
}

TEST(BakeTextures, RefuseWhatHasNoDirections) {
  PointCloud cloud = ripples(100);
  EXPECT_THROW(bake_textures({}, cloud), InputError);
  cloud.normals.pop_back();
  EXPECT_THROW(bake_textures(mesh::icosphere(1), cloud), InputError);
}

}  // namespace
}  // namespace dynasurf::cloud
