#include "dynasurf/io/study_io.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "dynasurf/core/error.hpp"

#include "support/l_shape.hpp"
#include "support/mutations.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf {
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
  Study study = test::l_shape_study(test::oblique_grid(true), 4);
  EXPECT_THAT(last_fact(study), HasSubstr("both surfaces of 4 gates, their volumes and the ejection fraction"));
  study.view = View::horizontal_long_axis;
  EXPECT_THAT(last_fact(study), HasSubstr("refuse: the slices are horizontal long axis"));
  study.view = View::unknown;
  study.gates.resize(1);
  EXPECT_THAT(last_fact(study), HasSubstr("taking the slices as short-axis; no ejection fraction"));
  std::fill(study.gates[0].values.begin(), study.gates[0].values.end(), 3.f);
  EXPECT_THAT(last_fact(study), HasSubstr("same value"));
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
}  // namespace dynasurf
