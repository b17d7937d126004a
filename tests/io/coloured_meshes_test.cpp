#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/png.hpp"
#include "dynasurf/io/mesh_io.hpp"

#include "support/sample_meshes.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using test::ScratchFolder;
using Json = nlohmann::json;

VertexColours striped(const TriMesh& mesh) {
  VertexColours colours;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    colours.push_back({static_cast<std::uint8_t>(v % 256), static_cast<std::uint8_t>(v % 2 == 0 ? 0 : 255), 100});
  return colours;
}

TEST(ColouredMesh, ComesBackWithItsColours) {
  const ScratchFolder folder;
  const TriMesh ball = test::lopsided_ball(2);
  const VertexColours colours = striped(ball);
  for (const MeshFormat format : {MeshFormat::ply, MeshFormat::obj, MeshFormat::off}) {
    const auto path = folder / ("ball." + std::string(word_of(format)));
    write_mesh(ball, path, format, {}, colours);
    EXPECT_EQ(read_mesh(path).vertices, ball.vertices) << word_of(format);

    const PointCloud cloud = read_cloud(std::vector{path}).cloud;
    ASSERT_EQ(cloud.colours.size(), cloud.points.size()) << word_of(format);
    // The vertices are the first samples, in their order.
    for (std::size_t v = 0; v < colours.size(); ++v) EXPECT_EQ(cloud.colours[v], colours[v]) << word_of(format);
  }
}

TEST(ColouredMesh, IsWrittenWithoutColoursWhereTheFormatHasNone) {
  const ScratchFolder folder;
  const TriMesh ball = test::lopsided_ball(1);
  for (const MeshFormat format : {MeshFormat::stl, MeshFormat::vtp}) {
    write_mesh(ball, folder / "with", format, {}, striped(ball));
    write_mesh(ball, folder / "without", format);
    EXPECT_EQ(test::read_bytes(folder / "with"), test::read_bytes(folder / "without"));
  }
}

TEST(ColouredMesh, IsRefusedWithColoursOfAnotherLength) {
  const ScratchFolder folder;
  const TriMesh ball = test::lopsided_ball(1);
  VertexColours colours = striped(ball);
  colours.pop_back();
  EXPECT_THROW(write_mesh(ball, folder / "a.ply", MeshFormat::ply, {}, colours), OptionError);
  const LodSurface level{"a", ball, colours, 0, {}};
  EXPECT_THROW(write_lod_glb({&level, 1}, folder / "a.glb"), OptionError);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.glb"));
}

/// A GLB taken apart: its JSON and its one buffer.
struct Glb {
  Json json;
  std::string buffer;
  template <class T>
  T at(std::size_t accessor, std::size_t row, std::size_t component) const {
    const Json& a = json.at("accessors").at(accessor);
    const Json& view = json.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
    const std::size_t components = a.at("type") == "SCALAR" ? 1 : a.at("type") == "VEC3" ? 3 : 4;
    return detail::load<T>(buffer.data() + view.value("byteOffset", 0u) + (row * components + component) * sizeof(T));
  }
};
Glb read_glb(const std::filesystem::path& path) {
  const std::string bytes = test::read_bytes(path);
  const auto length = detail::load<std::uint32_t>(bytes.data() + 12);
  return {Json::parse(bytes.substr(20, length)), bytes.substr(20 + length + 8)};
}

TEST(WriteMesh, WritesOneMeshAsAGlbWithItsColoursAndScalars) {
  const ScratchFolder folder;
  TriMesh far = test::lopsided_ball(2);
  for (Vec3& p : far.vertices) p += Vec3(500'000, 4'000'000, 0);
  const VertexColours colours = striped(far);
  std::vector<float> heights;
  for (const Vec3& p : far.vertices) heights.push_back(static_cast<float>(p[2]));
  write_mesh(far, folder / "a.glb", MeshFormat::glb, std::vector<VertexScalar>{{"height_mm", heights}}, colours);
  const Glb glb = read_glb(folder / "a.glb");
  ASSERT_EQ(glb.json.at("nodes").size(), 1u);
  EXPECT_EQ(glb.json.at("scenes")[0].at("nodes"), Json({0}));
  const Json& translation = glb.json.at("nodes")[0].at("translation");
  const Json& primitive = glb.json.at("meshes")[0].at("primitives")[0];
  const auto accessor = [&](const char* name) { return primitive.at("attributes").at(name).get<std::size_t>(); };
  for (std::size_t v = 0; v < far.vertices.size(); ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      // Single precision within the ball has steps of 4e-6.
      EXPECT_NEAR(translation[axis].get<double>() + static_cast<double>(glb.at<float>(accessor("POSITION"), v, axis)),
                  far.vertices[v][static_cast<Eigen::Index>(axis)], 1e-5);
    EXPECT_EQ(glb.at<float>(accessor("_HEIGHT_MM"), v, 0), heights[v]);
    EXPECT_EQ(glb.at<std::uint16_t>(accessor("COLOR_0"), v, 1), colours[v][1] == 0 ? 0 : 65535);
  }
  const auto indices = primitive.at("indices").get<std::size_t>();
  ASSERT_EQ(glb.json.at("accessors")[indices].at("count"), 3 * far.triangles.size());
  for (std::size_t t = 0; t < far.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(glb.at<std::uint32_t>(indices, 3 * t + c, 0), far.triangles[t][c]);
}

TEST(WriteLodGlb, NamesTheLevelsByTheirExtension) {
  const ScratchFolder folder;
  std::vector<LodSurface> levels;
  for (const int fineness : {3, 2, 1})
    levels.push_back({"level" + std::to_string(4 - fineness), test::lopsided_ball(fineness), {}, 0.1 * fineness, {}});
  write_lod_glb(levels, folder / "a.glb");
  const Glb glb = read_glb(folder / "a.glb");
  EXPECT_EQ(glb.json.at("extensionsUsed"), Json({"MSFT_lod"}));
  EXPECT_FALSE(glb.json.contains("extensionsRequired")) << "viewers without it show the finest";
  const Json& nodes = glb.json.at("nodes");
  ASSERT_EQ(nodes.size(), 3u);
  EXPECT_EQ(nodes[0].at("extensions").at("MSFT_lod").at("ids"), Json({1, 2}));
  EXPECT_EQ(nodes[0].at("extras").at("MSFT_screencoverage").size(), 3u);
  EXPECT_EQ(nodes[2].at("name"), "level3");
  EXPECT_EQ(glb.json.at("scenes")[0].at("nodes"), Json({0}));
}

TEST(WriteLodGlb, KeepsThePrecisionOfPlacesFarAway) {
  const ScratchFolder folder;
  TriMesh far = test::lopsided_ball(2);
  for (Vec3& p : far.vertices) p += Vec3(500'000, 4'000'000, 0);  // metres of a map projection
  const LodSurface level{"a", far, {}, 0, {}};
  write_lod_glb({&level, 1}, folder / "a.glb");
  const Glb glb = read_glb(folder / "a.glb");
  const Json& translation = glb.json.at("nodes")[0].at("translation");
  const auto position = glb.json.at("meshes")[0].at("primitives")[0].at("attributes").at("POSITION").get<std::size_t>();
  for (std::size_t v = 0; v < far.vertices.size(); v += 7)
    for (std::size_t axis = 0; axis < 3; ++axis)
      // Single precision at 4,000,000 has steps of a quarter; here it has steps of 4e-6.
      EXPECT_NEAR(translation[axis].get<double>() + static_cast<double>(glb.at<float>(position, v, axis)),
                  far.vertices[v][static_cast<Eigen::Index>(axis)], 1e-5);
}

TEST(WriteLodGlb, HoldsColoursInLinearLight) {
  const ScratchFolder folder;
  const TriMesh ball = test::lopsided_ball(1);
  const LodSurface level{"a", ball, VertexColours(ball.vertices.size(), {0, 188, 255}), 0, {}};
  write_lod_glb({&level, 1}, folder / "a.glb");
  const Glb glb = read_glb(folder / "a.glb");
  const auto colour = glb.json.at("meshes")[0].at("primitives")[0].at("attributes").at("COLOR_0").get<std::size_t>();
  EXPECT_TRUE(glb.json.at("accessors")[colour].at("normalized").get<bool>());
  EXPECT_EQ(glb.at<std::uint16_t>(colour, 3, 0), 0);
  EXPECT_NEAR(glb.at<std::uint16_t>(colour, 3, 1) / 65535.0, 0.5, 0.004) << "188 in sRGB is half the light";
  EXPECT_EQ(glb.at<std::uint16_t>(colour, 3, 2), 65535);
  EXPECT_EQ(glb.at<std::uint16_t>(colour, 3, 3), 65535) << "opaque";
}

TEST(WriteLodGlb, EmbedsTexturesAsPng) {
  const ScratchFolder folder;
  LodSurface level{"a", test::lopsided_ball(0), {}, 0, {}};
  for (const auto& t : level.mesh.triangles)
    for (const auto v : t)
      level.textured.corners.push_back({level.mesh.vertices[v], {0, 0, 1}, {1, 0, 0}, {0.25F, 0.5F}});
  level.textured.normals = {3, 1, {{128, 128, 255}, {1, 2, 3}, {4, 5, 6}}};
  level.textured.colours = {1, 1, {{9, 8, 7}}};
  write_lod_glb({&level, 1}, folder / "a.glb");
  const Glb glb = read_glb(folder / "a.glb");
  ASSERT_EQ(glb.json.at("images").size(), 2u);
  const auto picture = [&](std::size_t image) {
    const Json& view = glb.json.at("bufferViews").at(glb.json.at("images")[image].at("bufferView").get<std::size_t>());
    test::write_bytes(folder / "a.png", glb.buffer.substr(view.value("byteOffset", 0u), view.at("byteLength")));
    return read_png(folder / "a.png");
  };
  EXPECT_EQ(picture(0).pixels, level.textured.normals.texels);
  EXPECT_EQ(picture(1).pixels, level.textured.colours.texels);
  const Json& material = glb.json.at("materials")[0];
  EXPECT_EQ(material.at("normalTexture").at("index"), 0);
  EXPECT_EQ(material.at("pbrMetallicRoughness").at("baseColorTexture").at("index"), 1);
  const Json& primitive = glb.json.at("meshes")[0].at("primitives")[0];
  for (const char* name : {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"})
    EXPECT_EQ(glb.json.at("accessors")[primitive.at("attributes").at(name).get<std::size_t>()].at("count"),
              level.textured.corners.size());
  level.textured.normals.texels.pop_back();
  EXPECT_THROW(write_lod_glb({&level, 1}, folder / "b.glb"), InputError);
}

TEST(WriteLodGlb, WritesSamplesForTheValidator) {
  const char* folder = std::getenv("DYNASURF_GLB_SAMPLES");
  if (folder == nullptr) GTEST_SKIP() << "runs as part of io/gltf_validator";
  const std::filesystem::path out(folder);
  std::vector<LodSurface> levels;
  for (const int fineness : {3, 2, 1}) {
    const TriMesh ball = test::lopsided_ball(fineness);
    levels.push_back({"level" + std::to_string(4 - fineness), ball, striped(ball), 0.1 * fineness, {}});
  }
  write_lod_glb(levels, out / "levels.glb");
  for (LodSurface& level : levels) {
    level.textured.normals = {2, 2, std::vector<std::array<std::uint8_t, 3>>(4, {128, 128, 255})};
    level.textured.colours = {1, 1, {{200, 100, 50}}};
    for (const auto& t : level.mesh.triangles)
      for (const auto v : t) level.textured.corners.push_back({level.mesh.vertices[v], {0, 0, 1}, {1, 0, 0}, {0, 1}});
  }
  write_lod_glb(levels, out / "textured.glb");
  const TriMesh ball = test::lopsided_ball(2);
  write_mesh(ball, out / "mesh.glb", MeshFormat::glb,
             std::vector<VertexScalar>{{"thickness_mm", std::vector<float>(ball.vertices.size(), 9)}}, striped(ball));
}

TEST(ReadLodGlb, GivesBackNamesAndMeshesOfAllLevels) {
  const ScratchFolder folder;
  std::vector<LodSurface> levels;
  for (const int fineness : {3, 1}) {
    TriMesh ball = test::lopsided_ball(fineness);
    for (Vec3& p : ball.vertices) p += Vec3(4e5, 5e6, 100);
    levels.push_back({"level" + std::to_string(fineness), ball, striped(ball), 0.1 * fineness, {}});
  }
  write_lod_glb(levels, folder / "levels.glb");
  const std::vector<LodSurface> read = read_lod_glb(folder / "levels.glb");
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(read[n].name, levels[n].name);
    EXPECT_EQ(read[n].mesh.triangles, levels[n].mesh.triangles);
    ASSERT_EQ(read[n].mesh.vertices.size(), levels[n].mesh.vertices.size());
    // Offsets from the middle have 24 bits, and the ball is a few units wide.
    for (std::size_t v = 0; v < read[n].mesh.vertices.size(); ++v)
      EXPECT_LT((read[n].mesh.vertices[v] - levels[n].mesh.vertices[v]).norm(), 1e-5);
  }
}

TEST(ReadLodGlb, RefusesDamagedFilesInOneLine) {
  const ScratchFolder folder;
  const TriMesh ball = test::lopsided_ball(1);
  const LodSurface level{"level1", ball, {}, 0, {}};
  write_lod_glb({&level, 1}, folder / "a.glb");
  const std::string whole = text_of_file(folder / "a.glb");
  for (const std::size_t size : {std::size_t{0}, std::size_t{11}, whole.size() / 2, whole.size() - 4}) {
    write_file(folder / "b.glb", whole.substr(0, size));
    EXPECT_THROW(read_lod_glb(folder / "b.glb"), InputError) << size;
  }
  std::string other = whole;  // the last corner names a vertex that is not there
  other.replace(other.size() - 4, 4, "\xff\xff\xff\x7f");
  write_file(folder / "b.glb", other);
  EXPECT_THROW(read_lod_glb(folder / "b.glb"), InputError);
}

TEST(WriteLodGlb, RefusesWhatCannotBeShown) {
  const ScratchFolder folder;
  EXPECT_THROW(write_lod_glb({}, folder / "a.glb"), InputError);
  const LodSurface nothing{"a", {}, {}, 0, {}};
  EXPECT_THROW(write_lod_glb({&nothing, 1}, folder / "a.glb"), InputError);
}

}  // namespace
}  // namespace dynasurf::io
