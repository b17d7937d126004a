#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/dicom_file.hpp"

// DICOM files that are no study, contradict themselves or are damaged.

namespace dynasurf::io {
namespace {

using test::DicomFile;
using test::drop;
using test::item_of;
using test::put;
using test::words_of;
using ::testing::HasSubstr;

TEST_F(DicomFile, WithMissingOrDoubleFramesIsRefused) {
  const auto with_vector = [&](const DcmTagKey& tag, std::size_t at, Uint16 value) {
    return refusal([&](DcmDataset& d) {
      auto entries = words_of(d, tag);
      entries.at(at) = value;
      put(d, tag, entries);
    });
  };
  EXPECT_THAT(with_vector(DCM_SliceVector, 3, 3), HasSubstr("frames 3 and 4 are both gate 1, slice 3"));
  EXPECT_THAT(with_vector(DCM_TimeSlotVector, 19, 1), HasSubstr("both gate 1, slice 5"));
  EXPECT_THAT(with_vector(DCM_SliceVector, 0, 0), HasSubstr("entry 1 of SliceVector is 0; expected 1 to 5"));
  EXPECT_THAT(with_vector(DCM_SliceVector, 4, 6), HasSubstr("expected 1 to 5"));
  EXPECT_THAT(with_vector(DCM_TimeSlotVector, 4, 5), HasSubstr("TimeSlotVector counts to 5"));
  EXPECT_THAT(with_vector(DCM_RRIntervalVector, 0, 2), HasSubstr("RRIntervalVector is 2"));
  EXPECT_THAT(refusal([](DcmDataset& d) {
                auto entries = words_of(d, DCM_SliceVector);
                entries.pop_back();
                put(d, DCM_SliceVector, entries);
              }),
              HasSubstr("SliceVector has 19 entries for 20 frames"));
  EXPECT_THAT(refusal([](DcmDataset& d) {  // the last frame is gone, from pixels and vectors alike
                put(d, DCM_NumberOfFrames, "19");
                for (const DcmTagKey& tag : {DCM_RRIntervalVector, DCM_TimeSlotVector, DCM_SliceVector}) {
                  auto entries = words_of(d, tag);
                  entries.pop_back();
                  put(d, tag, entries);
                }
                auto pixels = words_of(d, DCM_PixelData);
                pixels.resize(19 * 42);
                put(d, DCM_PixelData, pixels);
              }),
              HasSubstr("missing"));
}

TEST_F(DicomFile, ThatIsNoReconstructedStackIsRefusedSayingWhatItIs) {
  const auto of_kind = [&](const std::string& kind) {
    return refusal([&](DcmDataset& d) { put(d, DCM_ImageType, "ORIGINAL\\PRIMARY\\" + kind + "\\EMISSION"); });
  };
  EXPECT_THAT(of_kind("TOMO"), HasSubstr("reconstruct the projections first"));
  EXPECT_THAT(of_kind("GATED TOMO"), HasSubstr("reconstruct the projections first"));
  for (const char* kind : {"STATIC", "WHOLE BODY", "DYNAMIC", "GATED"})
    EXPECT_THAT(of_kind(kind), HasSubstr(std::string("planar ") + kind));
  EXPECT_THAT(of_kind("SOMETHING"), HasSubstr("value 3 of ImageType"));
  EXPECT_THAT(refusal([](DcmDataset& d) { drop(d, DCM_ImageType); }), HasSubstr("value 3 of ImageType"));
  EXPECT_THAT(refusal([](DcmDataset& d) { put(d, DCM_Modality, "US"); }),
              HasSubstr("not of modality NM, PT, MR or CT"));
  for (const char* kind : {UID_EnhancedPETImageStorage, UID_LegacyConvertedEnhancedCTImageStorage,
                           UID_LegacyConvertedEnhancedMRImageStorage})
    EXPECT_THAT(refusal([&](DcmDataset& d) { put(d, DCM_SOPClassUID, kind); }), HasSubstr("Enhanced")) << kind;
  EXPECT_THAT(
      refusal([](DcmDataset& d) { put(d, DCM_SOPClassUID, UID_MultiframeTrueColorSecondaryCaptureImageStorage); }),
      HasSubstr("screen capture"));
  EXPECT_THAT(refusal([](DcmDataset& d) { drop(d, DCM_PixelData); }), HasSubstr("no pixel data"));
}

TEST_F(DicomFile, ThatContradictsItselfIsRefused) {
  EXPECT_THAT(refusal([](DcmDataset& d) { put(d, DCM_Rows, std::vector<Uint16>{7}); }), HasSubstr("need 1960"));
  EXPECT_THAT(refusal([](DcmDataset& d) { put(d, DCM_NumberOfFrames, "21"); }), HasSubstr("20 entries for 21 frames"));
  EXPECT_THAT(refusal([](DcmDataset& d) { put(d, DCM_BitsStored, std::vector<Uint16>{17}); }),
              HasSubstr("expected 1 to 16"));
  EXPECT_THAT(refusal([](DcmDataset& d) { put(d, DCM_PixelSpacing, "2.5\\abc"); }), HasSubstr("not a number"));
  EXPECT_THAT(refusal([](DcmDataset& d) { put(d, DCM_PixelSpacing, "0\\2"); }), HasSubstr("voxel size"));
  EXPECT_THAT(refusal([](DcmDataset& d) { drop(d, DCM_PixelSpacing); }), HasSubstr("PixelSpacing"));
  EXPECT_THAT(refusal([](DcmDataset& d) { put(d, DCM_RescaleSlope, "0"); }), HasSubstr("RescaleSlope"));
  EXPECT_THAT(refusal([](DcmDataset& d) { put(d, DCM_RescaleSlope, "1e300"); }), HasSubstr("not a finite number"));
  EXPECT_THAT(refusal([](DcmDataset& d) {
                put(item_of(d, DCM_DetectorInformationSequence), DCM_ImageOrientationPatient, "1\\0\\0\\0.6\\0.8\\0");
              }),
              HasSubstr("right angles"));
  EXPECT_THAT(refusal([](DcmDataset& d) {
                put(item_of(d, DCM_DetectorInformationSequence), DCM_ImageOrientationPatient, "1\\0\\0\\0\\0\\0");
              }),
              HasSubstr("length 1"));
}

TEST_F(DicomFile, IsRefusedWhenCutAtAnyByte) {
  Grid grid = test::oblique_grid();
  grid.dims = {3, 2, 2};
  const std::string bytes = test::read_bytes(written(test::l_shape_study(grid, 2)));
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.dcm", bytes), std::vector<std::size_t>{});
  test::edit_dicom(
      scratch / "written.dcm", scratch / "rle.dcm", [](DcmDataset&) {}, EXS_RLELossless);
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.dcm", test::read_bytes(scratch / "rle.dcm"), 3),
            std::vector<std::size_t>{});
}

TEST_F(DicomFile, SurvivesFlippedBits) {
  Grid grid = test::oblique_grid();
  grid.dims = {3, 2, 2};
  const std::string bytes = test::read_bytes(written(test::l_shape_study(grid, 2)));
  EXPECT_GT(test::refused_of_flipped(scratch / "flip.dcm", bytes, 3000, 11, 128), 300);
  test::edit_dicom(
      scratch / "written.dcm", scratch / "rle.dcm", [](DcmDataset&) {}, EXS_RLELossless);
  EXPECT_GT(test::refused_of_flipped(scratch / "flip.dcm", test::read_bytes(scratch / "rle.dcm"), 2000, 12, 128), 200);
}

TEST_F(DicomFile, DeclaringFourGigabytesIsRefusedAtOnce) {
  EXPECT_THAT(refusal([](DcmDataset& d) {
                put(d, DCM_Rows, std::vector<Uint16>{65535});
                put(d, DCM_Columns, std::vector<Uint16>{65535});
              }),
              HasSubstr("at most 2048 MiB"));
  EXPECT_THAT(refusal([](DcmDataset& d) { put(d, DCM_Rows, std::vector<Uint16>{65535}); }),
              HasSubstr("pixel data are 1680 bytes"));
}

TEST_F(DicomFile, NestedDeeplyIsReadOrRefusedButNeverOverflowsTheStack) {
  const std::string bytes = test::read_bytes(written(truth));
  const auto nested = [&](int levels) {
    const std::string open("\x55\x00\x10\x10SQ\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\xff\xff\xff\xff", 20);
    const std::string close("\xfe\xff\x0d\xe0\0\0\0\0\xfe\xff\xdd\xe0\0\0\0\0", 16);
    std::string all = bytes;
    for (int n = 0; n < levels; ++n) all += open;
    for (int n = 0; n < levels; ++n) all += close;
    test::write_bytes(scratch / "deep.dcm", all);
    return test::refusal_of(scratch / "deep.dcm");
  };
  EXPECT_EQ(nested(8), "");
  EXPECT_THAT(nested(32), HasSubstr("nests sequences more than 32 deep"));
  EXPECT_THAT(nested(100000), HasSubstr("nests sequences more than 32 deep"));
}

}  // namespace
}  // namespace dynasurf::io
