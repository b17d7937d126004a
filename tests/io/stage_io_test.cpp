#include "dynasurf/io/detail/stage_io.hpp"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/study_io.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using detail::load;
using test::read_bytes;
using test::ScratchFolder;
using ::testing::HasSubstr;

/// i runs up, j to the left, k to the back; left-handed.
Grid turned_grid() {
  Grid g;
  g.dims = {2, 3, 4};
  g.spacing = {1.5, 2, 2.5};
  g.origin = {10, -20, 30};
  g.direction << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  return g;
}

Image counted(const Grid& grid) {
  Image image(grid);
  for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = static_cast<float>(i) + 0.5f;
  return image;
}

TEST(WriteVti, StatesGeometryAndPutsTheValuesBehindTheMarkup) {
  const ScratchFolder folder;
  const Image image = counted(turned_grid());
  const Mask mask(turned_grid(), 7);
  write_vti(image.grid, std::vector<VoxelArray>{{"intensity", image.values}, {"edges", mask.values}}, folder / "a.vti");
  const std::string bytes = read_bytes(folder / "a.vti");
  EXPECT_THAT(bytes, HasSubstr("WholeExtent=\"0 1 0 2 0 3\" Origin=\"10 -20 30\" Spacing=\"1.5 2 2.5\" "
                               "Direction=\"0 1 0 0 0 1 1 0 0\""));
  EXPECT_THAT(bytes, HasSubstr("type=\"UInt8\" Name=\"edges\" NumberOfComponents=\"1\" format=\"appended\" "
                               "offset=\"104\""));  // 8 for the length, 24 values of 4 bytes
  const std::size_t data = bytes.find("encoding=\"raw\">\n_") + 17;
  EXPECT_EQ(load<std::uint64_t>(bytes.data() + data), 24u * 4);
  EXPECT_EQ(load<float>(bytes.data() + data + 8 + 23 * 4), 23.5f);
  EXPECT_EQ(load<std::uint64_t>(bytes.data() + data + 104), 24u);
  EXPECT_EQ(bytes[data + 104 + 8], 7);
}

TEST(WriteNrrdVolume, StatesGeometryAndKeepsTheOrderOfTheVoxels) {
  const ScratchFolder folder;
  write_nrrd_volume(counted(turned_grid()), folder / "a.nrrd");
  const std::string bytes = read_bytes(folder / "a.nrrd");
  EXPECT_THAT(bytes, HasSubstr("type: float\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 3 4\n"
                               "space directions: (0,0,1.5) (2,0,0) (0,2.5,0)\nkinds: domain domain domain\n"));
  EXPECT_THAT(bytes, HasSubstr("space origin: (10,-20,30)\n\n"));
  const std::size_t data = bytes.find("\n\n") + 2;
  ASSERT_EQ(bytes.size() - data, 24u * 4);
  EXPECT_EQ(load<float>(bytes.data() + data + 5 * 4), 5.5f);

  write_nrrd_volume(Mask(turned_grid(), 3), folder / "b.nrrd");
  const std::string mask = read_bytes(folder / "b.nrrd");
  EXPECT_THAT(mask, HasSubstr("type: uint8\n"));
  EXPECT_EQ(mask.substr(mask.find("\n\n") + 2), std::string(24, '\3'));
}

TEST(WriteNrrdVolume, IsReadBackAsTheSameVolumeInTheSamePlace) {
  const ScratchFolder folder;
  const Image image = counted(turned_grid());
  write_nrrd_volume(image, folder / "a.nrrd");
  const Study study = read_study(folder / "a.nrrd");
  ASSERT_EQ(study.gates.size(), 1u);
  EXPECT_EQ(study.grid(), image.grid);
  EXPECT_EQ(study.gates[0].values, image.values);
}

TEST(WriteNrrdVectors, TurnsComponentsFromTheGridToTheWorld) {
  const ScratchFolder folder;
  const Grid grid = turned_grid();
  const std::vector<float> up(24, 1.0f), none(24, 0.0f), some(24, 0.25f);
  write_nrrd_vectors(grid, {up, none, some}, folder / "v.nrrd");
  const std::string bytes = read_bytes(folder / "v.nrrd");
  EXPECT_THAT(bytes, HasSubstr("dimension: 4\nspace: left-posterior-superior\nsizes: 3 2 3 4\n"
                               "space directions: none (0,0,1.5) (2,0,0) (0,2.5,0)\n"
                               "kinds: vector domain domain domain\n"));
  const std::size_t data = bytes.find("\n\n") + 2;
  ASSERT_EQ(bytes.size() - data, 24u * 12);
  // i is the world's z, j its x, k its y.
  EXPECT_EQ(load<float>(bytes.data() + data), 0.0f);
  EXPECT_EQ(load<float>(bytes.data() + data + 4), 0.25f);
  EXPECT_EQ(load<float>(bytes.data() + data + 8), 1.0f);
}

TEST(WriteVti, RefusesArraysThatDoNotFitTheGrid) {
  const ScratchFolder folder;
  const Grid grid = turned_grid();
  const std::vector<float> right(24), wrong(23);
  EXPECT_THROW(write_vti(grid, std::vector<VoxelArray>{{"a", wrong}}, folder / "a.vti"), InputError);
  EXPECT_THROW(write_vti(grid, std::vector<VoxelArray>{{"a", VectorSpans{right, right, wrong}}}, folder / "a.vti"),
               InputError);
  EXPECT_THROW(write_nrrd_vectors(grid, {right, wrong, right}, folder / "a.vti"), InputError);
  EXPECT_THROW(write_nrrd_volume(Image{}, folder / "a.vti"), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.vti"));
}

// Not a check by itself: leaves files for VTK (tests/oracles/vtk_reads.py).
TEST(WriteVti, WritesSamplesForVtk) {
  const char* folder = std::getenv("DYNASURF_VTK_SAMPLES");
  if (folder == nullptr) GTEST_SKIP() << "runs as part of io/vtk_reads";
  const Grid grid = turned_grid();
  std::vector<float> where[3], ones(grid.size(), 1.0f), none(grid.size(), 0.0f);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        const Vec3 p = to_world(grid, centre_of(grid, {i, j, k}));
        for (int axis = 0; axis < 3; ++axis) where[axis].push_back(static_cast<float>(p[axis]));
      }
  const Mask mask(grid, 1);
  write_vti(grid,
            std::vector<VoxelArray>{{"x", where[0]},
                                    {"y", where[1]},
                                    {"z", where[2]},
                                    {"mask", mask.values},
                                    {"field", VectorSpans{ones, none, none}}},
            std::filesystem::path(folder) / "stage.vti");
}

}  // namespace
}  // namespace dynasurf::io
