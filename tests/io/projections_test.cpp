#include <cstdlib>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/study.hpp"

#include "support/dicom_edit.hpp"

namespace dynasurf::io {
namespace {

using test::item_of;
using test::words_of;

/// Two gates of three views of 4 x 4 bins; no two counts are the same.
Projections sample(int gates = 2) {
  Projections p;
  p.size = 4;
  p.bin_mm = 5;
  p.centre = {10, 20, 30};
  p.angle_deg = {90, 120, 150};
  p.radius_mm = {200, 210.5, 220};
  p.cycle_ms = 900;
  for (int g = 0; g < gates; ++g) {
    p.gates.emplace_back(p.views() * p.bins());
    std::iota(p.gates.back().begin(), p.gates.back().end(), static_cast<float>(1000 * g));
  }
  return p;
}

class ProjectionsFile : public ::testing::Test {
 protected:
  test::ScratchFolder scratch;
  DcmFileFormat file;

  DcmDataset& written(const Projections& p, const DicomWriteOptions& options = {}) {
    write_projections(p, scratch / "a.dcm", options);
    file.clear();
    test::check(file.loadFile((scratch / "a.dcm").c_str()));
    return *file.getDataset();
  }
};

std::string text_of(DcmItem& item, const DcmTagKey& tag) {
  OFString text;
  test::check(item.findAndGetOFStringArray(tag, text));
  return text.c_str();
}

/// The numbers of a decimal string.
std::vector<double> numbers_of(DcmItem& item, const DcmTagKey& tag) {
  std::vector<double> numbers;
  Float64 number = 0;
  for (unsigned long n = 0; item.findAndGetFloat64(tag, number, n).good(); ++n) numbers.push_back(number);
  return numbers;
}

TEST_F(ProjectionsFile, HoldGatesThenViewsWithTheHeadAtTheTop) {
  const Projections p = sample();
  DcmDataset& data = written(p, {.counts_scale = 2});
  std::vector<Uint16> expected;
  for (int g = 0; g < 2; ++g)
    for (int view = 0; view < 3; ++view)
      for (int row : {3, 2, 1, 0})
        for (int column = 0; column < 4; ++column)
          expected.push_back(static_cast<Uint16>(2 * (1000 * g + 16 * view + 4 * row + column)));
  EXPECT_EQ(words_of(data, DCM_PixelData), expected);
  EXPECT_EQ(text_of(data, DCM_NumberOfFrames), "6");
  EXPECT_EQ(text_of(data, DCM_CountsAccumulated), std::to_string(std::accumulate(expected.begin(), expected.end(), 0)));
  EXPECT_THAT(words_of(data, DCM_Rows), testing::ElementsAre(4));
  EXPECT_THAT(words_of(data, DCM_Columns), testing::ElementsAre(4));
  EXPECT_THAT(words_of(data, DCM_TimeSlotVector), testing::ElementsAre(1, 1, 1, 2, 2, 2));
  EXPECT_THAT(words_of(data, DCM_AngularViewVector), testing::ElementsAre(1, 2, 3, 1, 2, 3));
  for (const DcmTagKey& tag : {DCM_EnergyWindowVector, DCM_DetectorVector, DCM_RotationVector, DCM_RRIntervalVector})
    EXPECT_THAT(words_of(data, tag), testing::ElementsAre(1, 1, 1, 1, 1, 1)) << tag;
  for (const DcmTagKey& tag :
       {DCM_NumberOfRRIntervals, DCM_NumberOfDetectors, DCM_NumberOfEnergyWindows, DCM_NumberOfRotations})
    EXPECT_THAT(words_of(data, tag), testing::ElementsAre(1)) << tag;
  EXPECT_THAT(words_of(data, DCM_NumberOfTimeSlots), testing::ElementsAre(2));
  EXPECT_EQ(text_of(data, DCM_ImageType), "ORIGINAL\\PRIMARY\\GATED TOMO\\EMISSION");
  EXPECT_EQ(text_of(data, DCM_FrameIncrementPointer),
            "(0054,0010)\\(0054,0020)\\(0054,0050)\\(0054,0060)\\(0054,0070)\\(0054,0090)");
}

TEST_F(ProjectionsFile, SayWhereTheCameraStoodAndHowItTurned) {
  DcmDataset& data = written(sample());
  DcmItem& rotation = item_of(data, DCM_RotationInformationSequence);
  EXPECT_THAT(numbers_of(rotation, DCM_StartAngle), testing::ElementsAre(90));
  EXPECT_THAT(numbers_of(rotation, DCM_AngularStep), testing::ElementsAre(30));
  EXPECT_EQ(text_of(rotation, DCM_RotationDirection), "CW");
  EXPECT_THAT(numbers_of(rotation, DCM_ScanArc), testing::ElementsAre(90));
  EXPECT_THAT(numbers_of(rotation, DCM_RadialPosition), testing::ElementsAre(200, 210.5, 220));
  EXPECT_THAT(words_of(rotation, DCM_NumberOfFramesInRotation), testing::ElementsAre(3));
  // At the patient's left its rows run from front to back (LPS), and its face looks at the centre from +x.
  DcmItem& detector = item_of(data, DCM_DetectorInformationSequence);
  EXPECT_EQ(text_of(detector, DCM_CollimatorType), "PARA");
  EXPECT_EQ(text_of(detector, DCM_FocalDistance), "0");
  EXPECT_THAT(numbers_of(detector, DCM_ImageOrientationPatient), testing::ElementsAre(0, 1, 0, 0, 0, -1));
  EXPECT_THAT(numbers_of(detector, DCM_ImagePositionPatient), testing::ElementsAre(210, 12.5, 37.5));
  EXPECT_THAT(numbers_of(data, DCM_PixelSpacing), testing::ElementsAre(5, 5));

  Projections back = sample();
  back.angle_deg = {200, 190, 180};
  DcmItem& other = item_of(written(back), DCM_RotationInformationSequence);
  EXPECT_THAT(numbers_of(other, DCM_StartAngle), testing::ElementsAre(340));
  EXPECT_THAT(numbers_of(other, DCM_AngularStep), testing::ElementsAre(10));
  EXPECT_EQ(text_of(other, DCM_RotationDirection), "CC");
  EXPECT_THAT(numbers_of(other, DCM_ScanArc), testing::ElementsAre(30));
}

TEST_F(ProjectionsFile, TellTheTimesOfTheirGates) {
  DcmItem& gated = item_of(written(sample()), DCM_GatedInformationSequence);
  EXPECT_THAT(numbers_of(gated, DCM_TriggerTime), testing::ElementsAre(0));
  DcmItem& data = item_of(gated, DCM_DataInformationSequence);
  EXPECT_EQ(text_of(data, DCM_NominalInterval), "900");
  EXPECT_THAT(numbers_of(data, DCM_FrameTime), testing::ElementsAre(450));
  for (const int slot : {0, 1})
    EXPECT_THAT(numbers_of(item_of(data, DCM_TimeSlotInformationSequence, slot), DCM_TimeSlotTime),
                testing::ElementsAre(450));

  Projections unknown = sample();
  unknown.cycle_ms = 0;
  DcmItem& untimed = item_of(item_of(written(unknown), DCM_GatedInformationSequence), DCM_DataInformationSequence);
  EXPECT_FALSE(untimed.tagExists(DCM_NominalInterval));
}

TEST_F(ProjectionsFile, OfOneGateHaveNoTimeSlots) {
  DcmDataset& data = written(sample(1));
  EXPECT_EQ(text_of(data, DCM_ImageType), "ORIGINAL\\PRIMARY\\TOMO\\EMISSION");
  for (const DcmTagKey& tag : {DCM_TimeSlotVector, DCM_RRIntervalVector, DCM_GatedInformationSequence})
    EXPECT_FALSE(data.tagExists(tag)) << tag;
  EXPECT_THAT(words_of(data, DCM_AngularViewVector), testing::ElementsAre(1, 2, 3));
}

TEST_F(ProjectionsFile, AreCleanInDciodvfy) {
  if (std::system("command -v dciodvfy > /dev/null") != 0)
    GTEST_SKIP() << "dciodvfy (package dicom3tools) is not installed";
  for (const int gates : {1, 2}) {
    written(sample(gates));
    const std::string said = (scratch / "said").string();
    EXPECT_NE(std::system(("dciodvfy " + (scratch / "a.dcm").string() + " > " + said + " 2>&1").c_str()), -1);
    std::istringstream lines(test::read_bytes(said));
    for (std::string line; std::getline(lines, line);) {
      // dciodvfy looks for FrameIncrementPointer within the item, where it never is; the standard wants the sequence.
      const bool false_alarm = line.find("TimeSlotInformationSequence") != std::string::npos &&
                               line.find("when condition unsatisfied") != std::string::npos;
      EXPECT_TRUE(line == "NMImage" || false_alarm) << line;
    }
  }
}

TEST_F(ProjectionsFile, AreRefusedWhereDicomCannotHoldThem) {
  const std::filesystem::path path = scratch / "b.dcm";
  EXPECT_THROW(write_projections({}, path), InputError);
  Projections many = sample(0);
  many.size = 1;
  many.angle_deg.assign(32767, 0.0);
  many.radius_mm.assign(32767, 200.0);
  many.gates.assign(2, std::vector<float>(32767));
  EXPECT_THROW(write_projections(many, path), InputError);
  Projections negative = sample();
  negative.gates[1].back() = -1;
  EXPECT_THROW(write_projections(negative, path), OptionError);
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace dynasurf::io
