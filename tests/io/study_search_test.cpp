#include <algorithm>
#include <fstream>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/io/study_io.hpp"

#include "support/dicom_edit.hpp"
#include "support/l_shape.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;
using test::put;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

class StudySearchOf : public ::testing::Test {
 protected:
  test::ScratchFolder scratch;
  const fs::path tree = scratch / "clinic";
  const Study truth = test::l_shape_study(test::oblique_grid(), 4);
  int files_ = 0;

  fs::path folder(const std::string& name) const {
    fs::create_directories(tree / name);
    return tree / name;
  }

  /// A file of all gates and slices, changed.
  fs::path write_whole(const std::string& place, const std::function<void(DcmDataset&)>& change, int gates = 4) {
    write_dicom(test::l_shape_study(test::oblique_grid(), gates), scratch / "whole.dcm");
    const fs::path file = folder(fs::path(place).parent_path()) / fs::path(place).filename();
    test::edit_dicom(scratch / "whole.dcm", file, [&](DcmDataset& d) {
      put(d, DCM_StudyInstanceUID, "2.25.1");
      put(d, DCM_SeriesInstanceUID, "2.25.2." + std::to_string(++files_));
      put(d, DCM_SOPInstanceUID, "2.25.3." + std::to_string(files_));
      change(d);
    });
    return file;
  }

  /// A file a slice and gate, all of one series, beside whatever stands in the folder.
  std::vector<fs::path> write_slices(const std::string& place, const std::string& examination) {
    const fs::path apart = scratch / "slices";
    const int series = ++files_;
    test::write_single_frames(truth, apart, [&](DcmDataset& d, int gate) {
      put(d, DCM_StudyInstanceUID, examination);
      put(d, DCM_SeriesInstanceUID, "2.25.2." + std::to_string(series));
      put(d, DCM_SOPInstanceUID, "2.25.4." + std::to_string(++files_));
      put(d, DCM_TriggerTime, std::to_string(200 * gate));
    });
    std::vector<fs::path> moved;
    for (const auto& entry : fs::directory_iterator(apart)) {
      moved.push_back(folder(place) / ("s" + std::to_string(series) + entry.path().filename().string()));
      fs::copy_file(entry.path(), moved.back());
    }
    fs::remove_all(apart);
    std::sort(moved.begin(), moved.end());
    return moved;
  }

  std::map<std::string, std::string> left_out(const StudySearch& found) const {
    std::map<std::string, std::string> reasons;
    for (const auto& [file, reason] : found.left_out) reasons[file.lexically_relative(tree).string()] = reason;
    return reasons;
  }
};

void keep(DcmDataset&) {}

TEST_F(StudySearchOf, SeriesOfOneFileASliceAndGateFindsThemAllWhereverTheyLie) {
  const auto first = write_slices("a", "2.25.1"), second = write_slices("mixed", "2.25.5"),
             third = write_slices("mixed", "2.25.6");
  ASSERT_EQ(first.size(), 20u);
  fs::create_directories(tree / "moved");
  std::vector<fs::path> spread = first;  // one examination over two folders
  fs::rename(first[3], spread[3] = tree / "moved" / "x");
  std::sort(spread.begin(), spread.end());
  const StudySearch found = search_studies(tree);
  ASSERT_EQ(found.studies.size(), 3u);
  EXPECT_THAT(found.left_out, ::testing::IsEmpty());
  std::vector<std::vector<fs::path>> files;
  for (auto study : found.studies) {
    std::sort(study.files.begin(), study.files.end());
    files.push_back(study.files);
  }
  EXPECT_THAT(files, UnorderedElementsAre(spread, second, third));
  std::set<int> examinations;
  for (const auto& study : found.studies) examinations.insert(study.examination);
  EXPECT_EQ(examinations.size(), 3u);
}

TEST_F(StudySearchOf, GatesThatAreAFileEachMakeOneStudy) {
  for (int gate = 0; gate < 4; ++gate) {
    Study one = truth;
    one.gates = {truth.gates[static_cast<std::size_t>(gate)]};
    one.time_ms.clear();
    write_dicom(one, scratch / "one.dcm");
    test::edit_dicom(scratch / "one.dcm", folder("gates") / ("g" + std::to_string(gate)), [&](DcmDataset& d) {
      put(d, DCM_StudyInstanceUID, "2.25.1");
      put(d, DCM_SeriesInstanceUID, "2.25.2");
      put(d, DCM_SOPInstanceUID, "2.25.3." + std::to_string(gate));
      put(d, DCM_TriggerTime, std::to_string(200 * gate));
    });
  }
  const StudySearch found = search_studies(tree);
  ASSERT_EQ(found.studies.size(), 1u);
  EXPECT_EQ(found.studies.front().files.size(), 4u);
}

TEST_F(StudySearchOf, AnExaminationOfMixedSeriesFindsTheGatedShortAxisAndSaysWhatElseItHolds) {
  const fs::path study = write_whole("dir/IM1", keep);
  write_whole("dir/IM2", [](DcmDataset& d) { put(d, DCM_ImageType, "ORIGINAL\\PRIMARY\\GATED TOMO\\EMISSION"); });
  write_whole("dir/IM3", [](DcmDataset& d) {
    const Uint16 one = 1;
    test::check(d.putAndInsertUint16Array(DCM_DetectorVector, &one, 1));
    put(d, DCM_ImageType, "ORIGINAL\\PRIMARY\\STATIC\\EMISSION");
  });
  write_whole("dir/IM4", keep, 1);
  write_whole("dir/IM5", [](DcmDataset& d) {
    put(d, DCM_SOPClassUID, UID_EnhancedSRStorage);
    put(d, DCM_Modality, "SR");
    test::drop(d, DCM_PixelData);
  });
  fs::copy_file(study, tree / "dir" / "IM6");
  std::ofstream(tree / "dir" / "letter.txt") << "no image\n";
  const StudySearch found = search_studies(tree);
  ASSERT_EQ(found.studies.size(), 1u);
  EXPECT_EQ(found.studies.front().files, std::vector<fs::path>{study});
  const auto reasons = left_out(found);
  EXPECT_THAT(reasons.at("dir/IM2"), HasSubstr("projections"));
  EXPECT_THAT(reasons.at("dir/IM3"), HasSubstr("STATIC"));
  EXPECT_THAT(reasons.at("dir/IM4"), HasSubstr("ungated"));
  EXPECT_EQ(reasons.at("dir/IM5"), "no image");
  EXPECT_EQ(reasons.at("dir/IM6"), "a copy of another file");
  EXPECT_EQ(reasons.at("dir/letter.txt"), "no DICOM, NIfTI or NRRD file");
  EXPECT_EQ(reasons.size(), 6u);
}

TEST_F(StudySearchOf, RestAndStressOfOneExaminationAreTwoStudies) {
  const fs::path rest = write_whole("IM1", [](DcmDataset& d) { put(d, DCM_SeriesDescription, "REST"); });
  const fs::path stress = write_whole("IM2", [](DcmDataset& d) { put(d, DCM_SeriesDescription, "STRESS"); });
  const StudySearch found = search_studies(tree);
  ASSERT_EQ(found.studies.size(), 2u);
  EXPECT_EQ(found.studies[0].files, std::vector<fs::path>{rest});
  EXPECT_EQ(found.studies[1].files, std::vector<fs::path>{stress});
  EXPECT_THAT(found.studies[0].what, ::testing::EndsWith(", rest"));
  EXPECT_THAT(found.studies[1].what, ::testing::EndsWith(", stress"));
  EXPECT_EQ(found.studies[0].examination, found.studies[1].examination);
}

TEST_F(StudySearchOf, ADamagedSeriesIsAStudyThatTellsSoAndCostsNoOther) {
  const auto good = write_slices("good", "2.25.5");
  const auto broken = write_slices("broken", "2.25.6");
  fs::resize_file(broken[0], fs::file_size(broken[0]) / 2);
  const StudySearch found = search_studies(tree);
  const bool has_good = std::any_of(found.studies.begin(), found.studies.end(),
                                    [&](const auto& study) { return study.files.size() == good.size(); });
  const bool tells_broken = std::any_of(found.studies.begin(), found.studies.end(), [&](const auto& study) {
    return std::find(study.files.begin(), study.files.end(), broken[0]) != study.files.end();
  });
  EXPECT_TRUE(has_good);
  EXPECT_TRUE(tells_broken);
}

TEST_F(StudySearchOf, ProjectionsTellsNothingOfTheirOwnText) {
  for (int n = 0; n < 3; ++n)
    write_whole("p" + std::to_string(n),
                [](DcmDataset& d) { put(d, DCM_ImageType, "ORIGINAL\\PRIMARY\\TOMO\\EMISSION\\DOE JANE"); });
  const StudySearch found = search_studies(tree);
  std::vector<std::string> reasons;
  for (const auto& [file, reason] : left_out(found)) reasons.push_back(reason);
  EXPECT_EQ(reasons.size(), 3u);
  EXPECT_THAT(reasons, Each(AllOf(HasSubstr("projections"), ::testing::Not(HasSubstr("DOE")))));
}

}  // namespace
}  // namespace dynasurf::io
