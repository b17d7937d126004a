#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/study_io.hpp"

#include "support/l_shape.hpp"
#include "support/mutations.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Files of other makers, in the folder named by DYNASURF_TEST_DATA; they are not part of this project.
class RealFile : public ::testing::Test {
 protected:
  fs::path data;
  void SetUp() override {
    const char* folder = std::getenv("DYNASURF_TEST_DATA");
    if (!folder || !fs::is_directory(folder)) GTEST_SKIP() << "DYNASURF_TEST_DATA names no folder with test files";
    data = folder;
  }
};

TEST_F(RealFile, OfAHorizontalLongAxisIsReadAsSuch) {
  const Study study = read_study(data / "nm/NM-MONO2-16-13x-heart.dcm");
  EXPECT_EQ(study.view, View::horizontal_long_axis);
  EXPECT_EQ(study.image_type, "RECON TOMO");
  EXPECT_EQ(study.gates.size(), 1u);
  EXPECT_EQ(study.grid().dims, (Index3{64, 64, 13}));
  EXPECT_LT((study.grid().spacing - Vec3(3.11583, 3.11583, 6.231669)).norm(), 1e-9);
  EXPECT_EQ(*std::max_element(study.gates[0].values.begin(), study.gates[0].values.end()), 141)
      << "LargestImagePixelValue";
}

TEST_F(RealFile, OfProjectionsIsRefused) {
  EXPECT_THAT(test::refusal_of(data / "nm/RIMD_00001.dcm"), HasSubstr("reconstruct the projections first"));
}

TEST_F(RealFile, AsDicomAndNiftiHoldsTheSameVolumes) {
  for (const char* name : {"mean", "asymp100", "mi2100"}) {
    const Study dicom = read_study(data / "atlas" / name / "gspect_noisy.dcm");
    const Study nifti = read_study(data / "atlas" / name / "gspect_noisy.nii.gz");
    ASSERT_EQ(dicom.gates.size(), 8u);
    ASSERT_EQ(nifti.gates.size(), 8u);
    for (std::size_t g = 0; g < 8; ++g) EXPECT_EQ(dicom.gates[g].values, nifti.gates[g].values);
    EXPECT_EQ(dicom.grid().dims, (Index3{64, 64, 23}));
    // The NIfTI copies of these studies have the identity as their RAS affine where the DICOM files have it as LPS:
    // they declare the heart turned by half a turn about the long axis, and that is what must be read.
    const Mat3 half_turn = Vec3(-1, -1, 1).asDiagonal();
    for (const Index3& v : {Index3{0, 0, 0}, Index3{63, 5, 7}, Index3{1, 63, 22}}) {
      const Vec3 a = to_world(dicom.grid(), centre_of(dicom.grid(), v));
      const Vec3 b = to_world(nifti.grid(), centre_of(nifti.grid(), v));
      EXPECT_LT((half_turn * a - b).norm(), 1e-4);
    }
    EXPECT_EQ(dicom.cycle_ms, 800);
    EXPECT_TRUE(nifti.time_ms.empty()) << "a step of 1 s is no heart beat";
  }
}

TEST_F(RealFile, CutAnywhereInItsHeaderOrPixelsIsRefused) {
  const test::ScratchFolder scratch;
  const std::string packed = test::read_bytes(data / "atlas/mean/gspect_noisy.nii.gz");
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.nii.gz", packed, packed.size() / 50), std::vector<std::size_t>{});
  const std::string whole = test::read_bytes(data / "atlas/mean/gspect_noisy.dcm");
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.dcm", whole.substr(0, 3200), 5), std::vector<std::size_t>{});
  for (std::size_t n = 3200; n < whole.size(); n += whole.size() / 100) {
    test::write_bytes(scratch / "cut.dcm", whole.substr(0, n));
    EXPECT_NE(test::refusal_of(scratch / "cut.dcm"), "") << n;
  }
}

}  // namespace
}  // namespace dynasurf::io
