#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/gzip.hpp"
#include "dynasurf/io/detail/nifti_format.hpp"
#include "dynasurf/io/study_io.hpp"

#include "support/l_shape.hpp"
#include "support/mutations.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using test::read_bytes;
using test::write_bytes;
using ::testing::HasSubstr;

// Positions in a NIfTI file are 32-bit floats: 1e-5 mm over some 100 mm.
constexpr double float_tolerance_mm = 1e-4;

class NiftiFile : public ::testing::Test {
 protected:
  test::ScratchFolder scratch;

  std::filesystem::path file(const std::string& bytes, const std::string& name = "study.nii") {
    write_bytes(scratch / name, bytes);
    return scratch / name;
  }
  std::string written(const Study& study) {
    write_nifti(study, scratch / "written.nii");
    return read_bytes(scratch / "written.nii");
  }
  Study read(const std::string& bytes) { return read_study(file(bytes)); }
  std::string refusal(const std::string& bytes, const std::string& name = "study.nii") {
    return test::refusal_of(file(bytes, name));
  }
};

template <class T>
void set(std::string& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

void reverse_at(std::string& bytes, std::size_t offset, std::size_t width, std::size_t count = 1) {
  for (std::size_t n = 0; n < count; ++n, offset += width)
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                 bytes.begin() + static_cast<std::ptrdiff_t>(offset + width));
}

/// A file of our writer as a big-endian machine would have written it.
std::string big_endian_copy(std::string bytes) {
  using namespace nifti;
  reverse_at(bytes, 0, 4);
  reverse_at(bytes, dim, 2, 8);
  reverse_at(bytes, datatype, 2, 2);
  reverse_at(bytes, pixdim, 4, 8);
  reverse_at(bytes, vox_offset, 4, 3);
  reverse_at(bytes, toffset, 4);
  reverse_at(bytes, qform_code, 2, 2);
  reverse_at(bytes, quatern, 4, 6 + 12);
  reverse_at(bytes, 352, 4, (bytes.size() - 352) / 4);
  return bytes;
}

TEST_F(NiftiFile, BringsAnAsymmetricObjectBackToItsPlace) {
  for (const bool left_handed : {false, true})
    for (const char* name : {"l.nii", "l.nii.gz"}) {
      const Study truth = test::l_shape_study(test::oblique_grid(left_handed), 4);
      write_nifti(truth, scratch / name);
      const Study back = read_study(scratch / name);
      test::expect_l_shape(back, truth, float_tolerance_mm);
      EXPECT_EQ(back.grid().direction.determinant() < 0, left_handed);
      EXPECT_EQ(back.format, "NIfTI");
      EXPECT_EQ(back.view, View::short_axis);
      EXPECT_EQ(back.slice_order, SliceOrder::apex_to_base);
      EXPECT_EQ(back.time_ms, truth.time_ms);
      EXPECT_EQ(back.cycle_ms, 800);
    }
}

TEST_F(NiftiFile, SaysTheSameInSformAndQform) {
  for (const bool left_handed : {false, true}) {
    const Study truth = test::l_shape_study(test::oblique_grid(left_handed), 1);
    std::string bytes = written(truth);
    set<std::int16_t>(bytes, nifti::sform_code, 0);
    // The quaternion is rounded to 32 bits too, and its scalar part is recomputed from the other three.
    test::expect_l_shape(read(bytes), truth, 1e-3);
  }
}

TEST_F(NiftiFile, PrefersSformToQform) {
  const Study truth = test::l_shape_study(test::oblique_grid(), 1);
  std::string bytes = written(truth);
  for (std::size_t n = 0; n < 3; ++n) set<float>(bytes, nifti::quatern + 4 * n, 0);
  test::expect_l_shape(read(bytes), truth, float_tolerance_mm);
}

TEST_F(NiftiFile, PutsRightAnteriorSuperiorIntoLeftPosteriorSuperior) {
  Grid grid;
  grid.dims = {2, 2, 2};
  Study study = test::l_shape_study(grid, 1);
  std::string bytes = written(study);
  const float srow[12] = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
  std::memcpy(bytes.data() + nifti::srow, srow, sizeof srow);
  const Grid back = read(bytes).grid();
  EXPECT_EQ(back.origin, Vec3(-10, -20, 30));
  EXPECT_EQ(back.spacing, Vec3(2, 3, 4));
  EXPECT_EQ(back.direction, Mat3(Vec3(-1, -1, 1).asDiagonal()));
}

TEST_F(NiftiFile, ReadsBothByteOrders) {
  const Study truth = test::l_shape_study(test::oblique_grid(), 3);
  const std::string bytes = big_endian_copy(written(truth));
  test::expect_l_shape(read(bytes), truth, float_tolerance_mm);
}

template <class T>
std::string one_row_of(int code, const std::vector<T>& values, std::string bytes) {
  set<std::int16_t>(bytes, nifti::datatype, static_cast<std::int16_t>(code));
  set<std::int16_t>(bytes, nifti::bitpix, 8 * sizeof(T));
  set<std::int16_t>(bytes, nifti::dim + 2, static_cast<std::int16_t>(values.size()));
  set<std::int16_t>(bytes, nifti::dim + 4, 1);
  set<std::int16_t>(bytes, nifti::dim + 6, 1);
  bytes.resize(352);
  return bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

TEST_F(NiftiFile, ReadsEveryNumberTypeAndItsScale) {
  const std::string base = written(test::l_shape_study(test::oblique_grid(), 1));
  using Values = std::vector<float>;
  EXPECT_EQ(read(one_row_of<std::uint8_t>(2, {0, 200, 255}, base)).gates[0].values, (Values{0, 200, 255}));
  EXPECT_EQ(read(one_row_of<std::int8_t>(256, {-128, 0, 127}, base)).gates[0].values, (Values{-128, 0, 127}));
  EXPECT_EQ(read(one_row_of<std::uint16_t>(512, {0, 65535}, base)).gates[0].values, (Values{0, 65535}));
  EXPECT_EQ(read(one_row_of<std::int16_t>(4, {-32768, 32767}, base)).gates[0].values, (Values{-32768, 32767}));
  EXPECT_EQ(read(one_row_of<std::uint32_t>(768, {0, 4294967295u}, base)).gates[0].values, (Values{0, 4294967296.f}));
  EXPECT_EQ(read(one_row_of<std::int32_t>(8, {-70000, 70000}, base)).gates[0].values, (Values{-70000, 70000}));
  EXPECT_EQ(read(one_row_of<double>(64, {-0.5, 1e6}, base)).gates[0].values, (Values{-0.5, 1e6}));
  std::string scaled = one_row_of<std::int16_t>(4, {-2, 10}, base);
  set<float>(scaled, nifti::scl_slope, 0.5);
  set<float>(scaled, nifti::scl_inter, 3);
  EXPECT_EQ(read(scaled).gates[0].values, (Values{2, 8}));
  set<float>(scaled, nifti::scl_slope, 0);  // "not scaled", whatever the intercept says
  EXPECT_EQ(read(scaled).gates[0].values, (Values{-2, 10}));
}

TEST_F(NiftiFile, ConvertsUnitsOfLengthAndTime) {
  std::string bytes = written(test::l_shape_study(test::oblique_grid(), 8));
  bytes[nifti::xyzt_units] = nifti::unit_micrometre | nifti::unit_second;
  set<float>(bytes, nifti::pixdim + 16, 0.125f);
  const Study study = read(bytes);
  EXPECT_NEAR(study.grid().spacing[2], 5.75e-3, 1e-8);
  EXPECT_EQ(study.cycle_ms, 1000);
  EXPECT_EQ(study.time_ms[7], 875);
}

TEST_F(NiftiFile, TakesNoTimesFromAStepThatNobodyFilledIn) {
  std::string bytes = written(test::l_shape_study(test::oblique_grid(), 8));
  bytes[nifti::xyzt_units] = nifti::unit_millimetre | nifti::unit_second;
  set<float>(bytes, nifti::pixdim + 16, 1.f);
  const Study study = read(bytes);
  EXPECT_TRUE(study.time_ms.empty());
  EXPECT_EQ(study.cycle_ms, 0);
  ASSERT_EQ(study.notes.size(), 1u);
  EXPECT_EQ(study.notes[0].code, "nifti.no_gate_times");
}

TEST_F(NiftiFile, ReadsAPairOfHeaderAndImage) {
  const Study truth = test::l_shape_study(test::oblique_grid(), 2);
  std::string bytes = written(truth);
  std::memcpy(bytes.data() + nifti::magic, "ni1", 4);
  set<float>(bytes, nifti::vox_offset, 0);
  write_bytes(scratch / "pair.img", bytes.substr(352));
  const auto header = file(bytes.substr(0, 348), "pair.hdr");
  test::expect_l_shape(read_study(header), truth, float_tolerance_mm);
  EXPECT_EQ(files_of_study(header), (std::vector{header, scratch / "pair.img"}));
  write_bytes(scratch / "pair.img", bytes.substr(352, 100));
  EXPECT_THAT(test::refusal_of(header), HasSubstr("pair.img"));
  std::filesystem::remove(scratch / "pair.img");
  EXPECT_THAT(test::refusal_of(header), HasSubstr("is not beside it"));
}

TEST_F(NiftiFile, WritesTheSameBytesTwice) {
  const Study study = test::l_shape_study(test::oblique_grid(), 2);
  write_nifti(study, scratch / "a.nii.gz");
  write_nifti(study, scratch / "b.nii.gz");
  EXPECT_EQ(read_bytes(scratch / "a.nii.gz"), read_bytes(scratch / "b.nii.gz"));
}

TEST_F(NiftiFile, IsRefusedWhenCutAtAnyByte) {
  Grid grid = test::oblique_grid();
  grid.dims = {3, 2, 2};
  const std::string bytes = written(test::l_shape_study(grid, 2));
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.nii", bytes), std::vector<std::size_t>{});
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.nii.gz", gzip(bytes)), std::vector<std::size_t>{});
}

TEST_F(NiftiFile, IsRefusedWhenLongerThanItSays) {
  const std::string bytes = written(test::l_shape_study(test::oblique_grid(), 2));
  EXPECT_THAT(refusal(bytes + '\0'), HasSubstr("more data than its header declares"));
  EXPECT_THAT(refusal(gzip(bytes + '\0'), "long.nii.gz"), HasSubstr("more data than its header declares"));
  EXPECT_THAT(refusal(gzip(bytes) + "junk", "junk.nii.gz"), HasSubstr("gzip stream is damaged"));
  EXPECT_EQ(test::refusal_of(file(gzip(bytes.substr(0, 400)) + gzip(bytes.substr(400)), "two.nii.gz")), "");
}

TEST_F(NiftiFile, DeclaringFourGigabytesIsRefusedAtOnce) {
  std::string bytes = written(test::l_shape_study(test::oblique_grid(), 1)).substr(0, 400);
  for (std::size_t d = 1; d <= 3; ++d) set<std::int16_t>(bytes, nifti::dim + 2 * d, 1024);
  EXPECT_THAT(refusal(bytes), HasSubstr("at most 2048 MiB"));
  for (std::size_t d = 1; d <= 3; ++d) set<std::int16_t>(bytes, nifti::dim + 2 * d, 800);
  EXPECT_THAT(refusal(bytes), HasSubstr("is cut off"));
  EXPECT_THAT(refusal(gzip(bytes), "bomb.nii.gz"), HasSubstr("is cut off"));
  for (std::size_t d = 0; d <= 7; ++d) set<std::int16_t>(bytes, nifti::dim + 2 * d, d == 0 ? 7 : 32767);
  EXPECT_THAT(refusal(bytes), HasSubstr("dimension 5"));
}

TEST_F(NiftiFile, ThatNeedsMoreMemoryThanTheLimitIsRefusedBeforeItIsUnpacked) {
  std::string bytes = written(test::l_shape_study(test::oblique_grid(), 1)).substr(0, 352);
  for (std::size_t d = 1; d <= 3; ++d) set<std::int16_t>(bytes, nifti::dim + 2 * d, 200);
  bytes.resize(352 + 4 * 200 * 200 * 200);
  const auto path = file(gzip(bytes), "zeros.nii.gz");
  ASSERT_LT(std::filesystem::file_size(path), 100'000u);
  EXPECT_EQ(test::refusal_of(path), "");
  const MemoryLimit limit(std::uint64_t{300} << 20);
  EXPECT_THAT(test::refusal_of(path),
              HasSubstr("of memory for 200 x 200 x 200 voxels x 1 gates; the limit is 300 MiB"));
}

TEST_F(NiftiFile, NamesTheFirstVoxelThatIsNotANumber) {
  std::string bytes = written(test::l_shape_study(test::oblique_grid(), 2));
  const std::size_t voxel = 7 * 6 * 5 + (7 * 6) * 3 + 7 * 2 + 1;
  set<float>(bytes, 352 + 4 * voxel, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(refusal(bytes), HasSubstr("voxel (1,2,3) of gate 2 is not a finite number"));
  set<float>(bytes, 352 + 4 * voxel, -std::numeric_limits<float>::infinity());
  EXPECT_THAT(refusal(bytes), HasSubstr("voxel (1,2,3) of gate 2"));
}

TEST_F(NiftiFile, IsRefusedWithTheReason) {
  const std::string good = written(test::l_shape_study(test::oblique_grid(), 2));
  const auto changed = [&](std::size_t offset, auto value) {
    std::string bytes = good;
    set(bytes, offset, value);
    return refusal(bytes);
  };
  EXPECT_THAT(changed(nifti::dim, std::int16_t{2}), HasSubstr("2 dimensions"));
  EXPECT_THAT(changed(nifti::dim + 2, std::int16_t{-7}), HasSubstr("extent of dimension 1 is -7"));
  EXPECT_THAT(changed(nifti::datatype, std::int16_t{128}), HasSubstr("data type 128 is not read"));
  EXPECT_THAT(changed(nifti::bitpix, std::int16_t{16}), HasSubstr("16 bits per voxel"));
  EXPECT_THAT(changed(nifti::srow + 4, 1.f), HasSubstr("not at right angles"));
  EXPECT_THAT(changed(nifti::srow, std::numeric_limits<float>::quiet_NaN()), HasSubstr("not a finite number"));
  EXPECT_THAT(changed(nifti::vox_offset, 100.f), HasSubstr("vox_offset"));
  EXPECT_THAT(changed(nifti::vox_offset, 2e7f),
              HasSubstr("vox_offset is 20000000.000000; expected a whole number from 352 to "));
  EXPECT_THAT(changed(nifti::magic, std::int32_t{0}), HasSubstr("Analyze"));
  EXPECT_THAT(changed(nifti::xyzt_units, std::uint8_t{7}), HasSubstr("unit of length"));
}

TEST_F(NiftiFile, NotesThatLeftAndRightAreUnknownWithoutOrientation) {
  std::string bytes = written(test::l_shape_study(test::oblique_grid(), 1));
  set<std::int16_t>(bytes, nifti::sform_code, 0);
  set<std::int16_t>(bytes, nifti::qform_code, 0);
  const Study study = read(bytes);
  ASSERT_EQ(study.notes.size(), 1u);
  EXPECT_EQ(study.notes[0].code, "nifti.no_orientation");
}

TEST_F(NiftiFile, WithAVoxelSizeBelowZeroIsRefusedWhereThatIsAllItSays) {
  for (const bool has_quaternion : {false, true}) {
    std::string bytes = written(test::l_shape_study(test::oblique_grid(), 1));
    set<std::int16_t>(bytes, nifti::sform_code, 0);
    set<std::int16_t>(bytes, nifti::qform_code, std::int16_t{has_quaternion});
    ASSERT_EQ(refusal(bytes), "");
    set<float>(bytes, nifti::pixdim + 4, -3.f);
    EXPECT_THAT(refusal(bytes), HasSubstr("pixdim[1] is -3.0"));
    set<std::int16_t>(bytes, nifti::sform_code, 1);
    EXPECT_EQ(refusal(bytes), "") << "the sform says all";
  }
}

TEST_F(NiftiFile, SurvivesFlippedBits) {
  Grid grid = test::oblique_grid();
  grid.dims = {3, 2, 2};
  const std::string bytes = written(test::l_shape_study(grid, 2));
  EXPECT_GT(test::refused_of_flipped(scratch / "flip.nii", bytes, 3000, 1), 100);
  EXPECT_GT(test::refused_of_flipped(scratch / "flip.nii.gz", gzip(bytes), 3000, 2), 2000);
}

}  // namespace
}  // namespace dynasurf::io
