#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/measures.hpp"

#include "support/sample_meshes.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using test::lopsided_ball;
using test::read_bytes;
using test::ScratchFolder;

const TriMesh one_triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};

constexpr MeshFormat readable[] = {MeshFormat::ply, MeshFormat::stl, MeshFormat::obj, MeshFormat::off};

std::filesystem::path file_for(const ScratchFolder& folder, MeshFormat format) {
  return folder / ("mesh." + std::string(names_of(format)[static_cast<std::size_t>(format)]));
}

TriMesh through_a_file(const TriMesh& mesh, MeshFormat format) {
  const ScratchFolder folder;
  const auto path = file_for(folder, format);
  write_mesh(mesh, path, format);
  return read_mesh(path);
}

TEST(WriteMesh, WritesAnObjOneCanReadAloud) {
  EXPECT_EQ(detail::encode_obj(one_triangle),
            "# SPACE=LPS\n# dynasurf, patient coordinates (LPS, mm) or those of the scan\n# Vertices: 3\n# Faces: 1\n"
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nf 1//1 2//2 3//3\n");
}

TEST(WriteMesh, WritesAnOffOneCanReadAloud) {
  EXPECT_EQ(
      detail::encode_off(one_triangle),
      "OFF\n# dynasurf, patient coordinates (LPS, mm) or those of the scan\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
}

TEST(WriteMesh, WritesAPlyOfTheDeclaredSize) {
  const std::vector<VertexScalar> scalars{{"thickness_mm", {1, 2, 3}}};
  const std::string bytes = detail::encode_ply(one_triangle, scalars);
  EXPECT_NE(bytes.find("property float thickness_mm\nelement face 1\n"), std::string::npos);
  const std::size_t body = bytes.size() - bytes.find("end_header\n") - 11;
  EXPECT_EQ(body, 3 * (3 * 8 + 3 * 4 + 4) + 1 * (1 + 3 * 4));
}

TEST(WriteMesh, NeverBeginsABinaryStlWithTheWordSolid) {
  const std::string bytes = detail::encode_stl(one_triangle);
  EXPECT_EQ(bytes.size(), 84u + 50u);
  EXPECT_NE(bytes.substr(0, 5), "solid");
}

TEST(WriteMesh, KeepsVerticesAndTrianglesExactlyWhereTheFormatCan) {
  const TriMesh mesh = lopsided_ball(2);
  for (const auto format : {MeshFormat::ply, MeshFormat::obj, MeshFormat::off}) {
    const TriMesh back = through_a_file(mesh, format);
    EXPECT_EQ(back.vertices, mesh.vertices) << word_of(format);
    EXPECT_EQ(back.triangles, mesh.triangles) << word_of(format);
  }
}

TEST(WriteMesh, KeepsVolumeTopologyAndHandednessInEveryFormat) {
  const TriMesh mesh = lopsided_ball(3);
  const mesh::Topology before = mesh::topology(mesh);
  ASSERT_TRUE(before.closed() && before.oriented());
  ASSERT_GT(mesh::volume_mm3(mesh), 0);
  for (const auto format : readable) {
    const TriMesh back = through_a_file(mesh, format);
    const mesh::Topology after = mesh::topology(back);
    EXPECT_EQ(after.vertices, before.vertices) << word_of(format);
    EXPECT_EQ(after.triangles, before.triangles) << word_of(format);
    EXPECT_EQ(after.euler, 2) << word_of(format);
    EXPECT_TRUE(after.closed() && after.oriented()) << word_of(format);
    // Single precision at 100 mm is 4e-6 mm; on 3e5 mm3 of a body of 60 mm that is well below 1e-6 of the volume.
    EXPECT_NEAR(mesh::volume_mm3(back) / mesh::volume_mm3(mesh), 1, format == MeshFormat::stl ? 1e-6 : 1e-15)
        << word_of(format);
  }
}

TEST(WriteMesh, PutsAPointWhereItWasOnEveryAxis) {
  TriMesh mesh = one_triangle;
  mesh.vertices = {{1, 2, 3}, {-40, 5, 6}, {7, -80, 9}};
  for (const auto format : readable) EXPECT_EQ(through_a_file(mesh, format).vertices, mesh.vertices) << word_of(format);
}

TEST(WriteMesh, GivesTheSameBytesEveryTime) {
  const ScratchFolder folder;
  const TriMesh mesh = lopsided_ball(2);
  const std::vector<VertexScalar> scalars{{"distance", std::vector<float>(mesh.vertices.size(), 0.5f)}};
  for (std::size_t f = 0; f < names_of(MeshFormat{}).size(); ++f) {
    const auto format = static_cast<MeshFormat>(f);
    write_mesh(mesh, folder / "a", format, scalars);
    write_mesh(mesh, folder / "b", format, scalars);
    EXPECT_FALSE(read_bytes(folder / "a").empty());
    EXPECT_EQ(read_bytes(folder / "a"), read_bytes(folder / "b")) << word_of(format);
  }
}

TEST(NormalsToWrite, PointOutwardsAndHaveUnitLength) {
  const TriMesh ball = mesh::icosphere(3);
  const auto normals = detail::normals_to_write(ball);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    EXPECT_NEAR(normals[v].norm(), 1, 1e-6);
    // The mean of the faces around a vertex of a fine ball leans from its radius by less than its mesh's half angle.
    EXPECT_GT(normals[v].cast<double>().dot(ball.vertices[v]), 0.99);
  }
}

TEST(NormalsToWrite, StandUprightWhereTheSurfaceHasNoDirection) {
  TriMesh mesh = one_triangle;
  mesh.vertices.push_back({5, 5, 5});                           // used by no triangle
  mesh.vertices.insert(mesh.vertices.end(), 3, Vec3(9, 9, 9));  // a triangle of no area
  mesh.triangles.push_back({4, 5, 6});
  for (const auto& n : detail::normals_to_write(mesh)) EXPECT_EQ(n, Eigen::Vector3f(0, 0, 1));
}

TEST(WriteMesh, RefusesAMeshThatIsNone) {
  const ScratchFolder folder;
  TriMesh no_triangle = one_triangle, bad_index = one_triangle, not_finite = one_triangle;
  no_triangle.triangles.clear();
  bad_index.triangles[0][1] = 3;
  not_finite.vertices[2][1] = std::numeric_limits<double>::quiet_NaN();
  for (const TriMesh& mesh : {no_triangle, bad_index, not_finite})
    for (std::size_t f = 0; f < names_of(MeshFormat{}).size(); ++f) {
      EXPECT_THROW(write_mesh(mesh, folder / "m", static_cast<MeshFormat>(f)), InputError);
      EXPECT_FALSE(std::filesystem::exists(folder / "m"));
    }
}

TEST(WriteMesh, RefusesScalarsThatDoNotFit) {
  const ScratchFolder folder;
  const auto write = [&](const VertexScalar& s) {
    write_mesh(one_triangle, folder / "m", MeshFormat::ply, std::vector{s});
  };
  EXPECT_NO_THROW(write({"quality", {1, 2, 3}}));
  EXPECT_THROW(write({"quality", {1, 2}}), OptionError);
  EXPECT_THROW(write({"two words", {1, 2, 3}}), OptionError);
  EXPECT_THROW(write({"x", {1, 2, 3}}), OptionError);
  EXPECT_THROW(write({"", {1, 2, 3}}), OptionError);
}

// Not a check by itself: leaves files for VTK (tests/oracles/vtk_reads.py).
TEST(WriteMesh, WritesSamplesForVtk) {
  const char* folder = std::getenv("DYNASURF_VTK_SAMPLES");
  if (folder == nullptr) GTEST_SKIP() << "runs as part of io/vtk_reads";
  const TriMesh mesh = lopsided_ball(3);
  VertexScalar height{"height", {}};
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3& p : mesh.vertices) {
    height.values.push_back(static_cast<float>(p[2]));
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (std::size_t f = 0; f < names_of(MeshFormat{}).size(); ++f)
    write_mesh(mesh, std::filesystem::path(folder) / ("ball." + std::string(names_of(MeshFormat{})[f])),
               static_cast<MeshFormat>(f), std::vector{height});
  std::ofstream expected(std::filesystem::path(folder) / "expected.txt");
  expected.precision(17);
  expected << "vertices=" << mesh.vertices.size() << "\ntriangles=" << mesh.triangles.size()
           << "\nvolume_mm3=" << mesh::volume_mm3(mesh) << "\nxmin=" << low[0] << "\nxmax=" << high[0]
           << "\nymin=" << low[1] << "\nymax=" << high[1] << "\nzmin=" << low[2] << "\nzmax=" << high[2] << "\n";
}

}  // namespace
}  // namespace dynasurf::io
