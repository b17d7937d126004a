#include "dynasurf/io/study_io.hpp"

#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "dynasurf/core/error.hpp"

#include "support/l_shape.hpp"
#include "support/mutations.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using ::testing::HasSubstr;

TEST(Study, OfOneObjectIsInTheSamePlaceInEveryFormat) {
  const test::ScratchFolder scratch;
  for (const bool left_handed : {false, true}) {
    const Study truth = test::l_shape_study(test::oblique_grid(left_handed), 3);
    write_dicom(truth, scratch / "l.dcm");
    write_nifti(truth, scratch / "l.nii.gz");
    write_nrrd(truth, scratch / "l.seq.nrrd");
    for (const char* name : {"l.dcm", "l.nii.gz", "l.seq.nrrd"}) {
      const Study back = read_study(scratch / name);
      test::expect_l_shape(back, truth, 1e-4);
      // The object itself, at the places where the file says its voxels are.
      const Grid& g = back.grid();
      for (int k = 0; k < g.dims[2]; ++k)
        for (int j = 0; j < g.dims[1]; ++j)
          for (int i = 0; i < g.dims[0]; ++i)
            ASSERT_EQ(back.gates[0](i, j, k), test::l_shape_at(to_world(g, centre_of(g, {i, j, k})), 0)) << name;
    }
  }
}

class FaultyStudy : public ::testing::Test {
 protected:
  test::ScratchFolder scratch;
  const Study truth = test::l_shape_study(test::oblique_grid(), 8);
  Study study = truth;

  Study back() {
    write_nifti(study, scratch / "study.nii");
    return read_study(scratch / "study.nii");
  }
  std::string refusal() {
    write_nifti(study, scratch / "study.nii");
    return test::refusal_of(scratch / "study.nii");
  }
};

TEST_F(FaultyStudy, WithValuesThatAreNoNumbersOutsideTheFieldIsRead) {
  Study expected = truth;
  for (Study* s : {&study, &expected})
    for (Image& gate : s->gates)
      for (int k = 0; k < 5; ++k)
        for (int j = 4; j < 6; ++j)
          for (int i = 5; i < 7; ++i)
            gate(i, j, k) = s == &expected ? 0
                            : i == 5       ? std::numeric_limits<float>::quiet_NaN()
                                           : -std::numeric_limits<float>::infinity();
  const Study read = back();
  for (std::size_t g = 0; g < 8; ++g) EXPECT_EQ(read.gates[g].values, expected.gates[g].values);
  ASSERT_EQ(read.notes.size(), 1u);
  EXPECT_EQ(read.notes[0].severity, Severity::info);
  EXPECT_EQ(read.notes[0].code, "study.not_finite");
  EXPECT_THAT(read.notes[0].message, HasSubstr("160 of 1680 values"));
  // One that is surrounded by numbers is a damage, not a rim.
  study.gates[2](3, 3, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(refusal(), HasSubstr("voxel (3,3,2) of gate 3 is not a finite number"));
}

TEST_F(FaultyStudy, ThatEndsInTheMiddleOfSomethingBrightIsDoubted) {
  const float brightest = *std::max_element(truth.gates[0].values.begin(), truth.gates[0].values.end());
  for (Image& gate : study.gates)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 7; ++i) gate(i, j, 0) = std::numeric_limits<float>::quiet_NaN();
  ASSERT_EQ(truth.gates[0](2, 1, 1), brightest);
  const Study read = back();
  EXPECT_EQ(read.notes.at(0).severity, Severity::warning);
  EXPECT_THAT(read.notes.at(0).message, HasSubstr("the field may cut"));
}

TEST_F(FaultyStudy, OfMostlyNoNumbersIsRefused) {
  for (Image& gate : study.gates)
    for (std::size_t v = 0; v <= gate.values.size() / 2; ++v) gate.values[v] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(refusal(), HasSubstr("voxel (0,0,0) of gate 1 is not a finite number; expected counts (848 of 1680"));
}

TEST_F(FaultyStudy, WithAHotVoxelGetsTheMedianOfItsNeighbours) {
  study.gates[3](6, 5, 4) = 80000;  // in the corner: seven neighbours, all of them background
  const Study read = back();
  EXPECT_EQ(read.gates[3](6, 5, 4), truth.gates[3](6, 5, 3));
  study.gates[3](6, 5, 4) = read.gates[3](6, 5, 4);
  for (std::size_t g = 0; g < 8; ++g) EXPECT_EQ(read.gates[g].values, study.gates[g].values);
  ASSERT_EQ(read.notes.size(), 1u);
  EXPECT_EQ(read.notes[0].code, "study.hot_voxel");
  EXPECT_EQ(read.notes[0].gate, 3);
  EXPECT_THAT(read.notes[0].message, HasSubstr("voxel (6,5,4) of gate 4"));
}

TEST_F(FaultyStudy, KeepsBrightVoxelsThatMayBeReal) {
  // Not much brighter than all else, beside another bright one, or one of many.
  study.gates[3](6, 5, 4) = 1500;
  EXPECT_EQ(back().gates[3](6, 5, 4), 1500);
  study.gates[3](6, 5, 4) = study.gates[3](5, 5, 4) = 80000;
  EXPECT_EQ(back().gates[3](6, 5, 4), 80000);
  EXPECT_TRUE(back().notes.empty());
  study = truth;
  for (Image& gate : study.gates) gate(6, 5, 4) = gate(6, 0, 4) = gate(6, 5, 0) = 80000;
  EXPECT_TRUE(back().notes.empty());
}

TEST_F(FaultyStudy, WithAnEmptyGateGetsTheMeanOfItsNeighboursAndIsDoubted) {
  const auto empty = [&](std::size_t g) {
    std::fill(study.gates[g].values.begin(), study.gates[g].values.end(), 0.0f);
  };
  empty(0);
  Study read = back();
  const std::size_t v = 7 * 6 + 7 + 2;  // in the L
  EXPECT_EQ(read.gates[0].values[v], (truth.gates[7].values[v] + truth.gates[1].values[v]) / 2);
  EXPECT_EQ(read.gates[1].values, truth.gates[1].values);
  EXPECT_EQ(read.time_ms, truth.time_ms);
  ASSERT_EQ(read.notes.size(), 1u);
  EXPECT_EQ(read.notes[0].severity, Severity::warning);
  EXPECT_THAT(read.notes[0].message, HasSubstr("gate 1 is empty: the mean of gates 8 and 2"));
  empty(7);  // two in a row, around the end of the beat
  read = back();
  EXPECT_FLOAT_EQ(read.gates[0].values[v], (truth.gates[6].values[v] + 2 * truth.gates[1].values[v]) / 3);
  EXPECT_EQ(read.notes.size(), 2u);
  empty(3);  // too many to guess
  EXPECT_EQ(back().gates[3].values[v], 0);
  EXPECT_TRUE(back().notes.empty());
}

TEST(Study, IsToldFromItsContentAndNotFromItsName) {
  const test::ScratchFolder scratch;
  const Study truth = test::l_shape_study(test::oblique_grid(), 2);
  write_dicom(truth, scratch / "a");
  write_nifti(truth, scratch / "b.nii");
  write_nrrd(truth, scratch / "c");
  std::filesystem::rename(scratch / "a", scratch / "x.nii.gz");
  std::filesystem::rename(scratch / "b.nii", scratch / "x.nrrd");
  std::filesystem::rename(scratch / "c", scratch / "x.dcm");
  EXPECT_EQ(read_study(scratch / "x.nii.gz").format, "DICOM");
  EXPECT_EQ(read_study(scratch / "x.nrrd").format, "NIfTI");
  EXPECT_EQ(read_study(scratch / "x.dcm").format, "NRRD");
}

TEST(Study, ThatCannotBeOpenedIsAnErrorOfTheFileSystem) {
  const test::ScratchFolder scratch;
  EXPECT_THROW(read_study(scratch / "absent.dcm"), IoError);
  ASSERT_EQ(::mkfifo((scratch / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(read_study(scratch / "pipe"), IoError);
  EXPECT_THROW(read_study("/dev/zero"), IoError);
  EXPECT_THROW(files_of_study(scratch / "absent.dcm"), IoError);
}

TEST(Study, OfJunkIsRefused) {
  const test::ScratchFolder scratch;
  test::write_bytes(scratch / "empty", "");
  EXPECT_THAT(test::refusal_of(scratch / "empty"), HasSubstr("is empty"));
  test::write_bytes(scratch / "text",
                    "This is no study, but it is longer than a hundred and thirty-two bytes. " + std::string(200, 'x'));
  EXPECT_THAT(test::refusal_of(scratch / "text"), HasSubstr("expected DICOM, NIfTI or NRRD"));
  test::write_bytes(scratch / "zeros", std::string(100000, '\0'));
  EXPECT_NE(test::refusal_of(scratch / "zeros"), "");
  test::write_bytes(scratch / "nifti2", std::string("\x1c\x02\0\0", 4) + std::string(600, '\0'));
  EXPECT_THAT(test::refusal_of(scratch / "nifti2"), HasSubstr("NIfTI-2"));
  test::Dice dice{5};
  for (int n = 0; n < 200; ++n) {
    std::string noise;
    for (int b = 0; b < 500; ++b) noise += static_cast<char>(dice(256));
    test::write_bytes(scratch / "noise", noise);
    EXPECT_NE(test::refusal_of(scratch / "noise"), "");
  }
}

TEST(StudyFacts, TellWhatTheProgramWouldDo) {
  const test::ScratchFolder scratch;
  const auto last_fact = [&](const Study& study) { return facts_of(scratch / "unused.nii", study).rows.back().second; };
  Grid grid = test::oblique_grid(true);
  grid.dims = {9, 8, 5};
  Study study = test::l_shape_study(grid, 4);
  EXPECT_THAT(last_fact(study), HasSubstr("both surfaces of 4 gates, their volumes and the ejection fraction"));
  study.view = View::horizontal_long_axis;
  EXPECT_THAT(last_fact(study), HasSubstr("cutting the horizontal long axis slices anew across the ventricle"));
  study.view = View::unknown;
  study.gates.resize(1);
  EXPECT_THAT(last_fact(study),
              HasSubstr("no ejection fraction, because the study is not gated, taking the slices as "));
  std::fill(study.gates[0].values.begin(), study.gates[0].values.end(), 3.f);
  EXPECT_THAT(last_fact(study), HasSubstr("same value"));
  study = test::l_shape_study(test::oblique_grid(), 4);  // 7 x 6 pixels
  EXPECT_THAT(last_fact(study), HasSubstr("refuse: at least 8 x 8 pixels in 3 slices are needed"));
}

TEST(StudyFacts, DescribeOrientationInWords) {
  Grid grid;
  grid.dims = {2, 2, 2};
  grid.direction << 0, 0, -1, 1, 0, 0, 0, 1, 0;
  Study study = test::l_shape_study(grid, 1);
  const auto value_of = [&](const std::string& name) {
    for (const auto& [key, value] : facts_of("unused.nii", study).rows)
      if (key == name) return value;
    return std::string("(none)");
  };
  EXPECT_EQ(value_of("columns lead to"), "posterior");
  EXPECT_EQ(value_of("rows lead to"), "superior");
  EXPECT_EQ(value_of("slices lead to"), "right");
  EXPECT_EQ(value_of("handedness"), "left-handed (negative slice spacing)");
  study.gates[0].grid.direction = Eigen::AngleAxisd(0.5235987755982988, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_EQ(value_of("columns lead to"), "left, 30 degrees towards posterior");
  EXPECT_EQ(value_of("handedness"), "(none)");
}

}  // namespace
}  // namespace dynasurf::io
