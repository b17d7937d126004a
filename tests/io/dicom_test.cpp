#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/dicom_file.hpp"

namespace dynasurf::io {
namespace {

using test::DicomFile;
using test::drop;
using test::item_of;
using test::put;
using test::words_of;
using ::testing::HasSubstr;

// Decimal strings of DICOM hold at least 12 digits of a position of some 100 mm.
constexpr double decimal_tolerance_mm = 1e-8;

bool has_note(const Study& study, const std::string& code) {
  return std::any_of(study.notes.begin(), study.notes.end(), [&](const Note& n) { return n.code == code; });
}

TEST_F(DicomFile, BringsAnAsymmetricObjectBackToItsPlace) {
  for (const bool left_handed : {false, true})
    for (const int gates : {1, 4}) {
      const Study study = test::l_shape_study(test::oblique_grid(left_handed), gates);
      const Study back = read_study(written(study));
      test::expect_l_shape(back, study, decimal_tolerance_mm);
      EXPECT_EQ(back.grid().direction.determinant() < 0, left_handed);
      EXPECT_EQ(back.format, "DICOM");
      EXPECT_EQ(back.modality, "NM");
      EXPECT_EQ(back.image_type, gates > 1 ? "RECON GATED TOMO" : "RECON TOMO");
      EXPECT_EQ(back.view, View::short_axis);
      EXPECT_EQ(back.slice_order, SliceOrder::apex_to_base);
      EXPECT_EQ(back.time_ms, study.time_ms);
      EXPECT_EQ(back.cycle_ms, study.cycle_ms);
      EXPECT_TRUE(back.notes.empty());
    }
}

TEST_F(DicomFile, KeepsEveryViewAndSliceOrder) {
  Study study = truth;
  for (const View view :
       {View::unknown, View::short_axis, View::horizontal_long_axis, View::vertical_long_axis, View::transaxial})
    for (const SliceOrder order : {SliceOrder::unknown, SliceOrder::apex_to_base, SliceOrder::base_to_apex}) {
      study.view = view;
      study.slice_order = order;
      const Study back = read_study(written(study));
      EXPECT_EQ(back.view, view);
      EXPECT_EQ(back.slice_order, order);
    }
}

TEST_F(DicomFile, TellsWhetherAttenuationWasCorrected) {
  Study study = truth;
  const auto read_back = [&](Attenuation attenuation, const std::string& description) {
    study.attenuation = attenuation;
    DicomWriteOptions options;
    options.series_description = description;
    write_dicom(study, scratch / "attenuation.dcm", options);
    return read_study(scratch / "attenuation.dcm").attenuation;
  };
  EXPECT_EQ(read_back(Attenuation::unknown, "Gated SA"), Attenuation::unknown);
  EXPECT_EQ(read_back(Attenuation::unknown, "Gated SA, AC"), Attenuation::corrected);
  EXPECT_EQ(read_back(Attenuation::uncorrected, "Stress_IRNC_SA"), Attenuation::uncorrected);
  EXPECT_EQ(read_back(Attenuation::corrected, "Gated SA"), Attenuation::corrected);
  EXPECT_EQ(read_back(Attenuation::corrected, "NAC"), Attenuation::corrected) << "the list of corrections leads";
  const auto with_list = [&](const char* corrections, const char* description) {
    return read_study(changed([&](DcmDataset& d) {
             put(d, DCM_CorrectedImage, corrections);
             put(d, DCM_SeriesDescription, description);
           }))
        .attenuation;
  };
  EXPECT_EQ(with_list("UNIF\\DECY", "Gated SA"), Attenuation::uncorrected);
  EXPECT_EQ(with_list("UNIF\\DECY", "Gated SA AC"), Attenuation::corrected) << "the list is of counts";
  EXPECT_EQ(with_list("UNIF\\ATTN", "Gated SA"), Attenuation::corrected);
  EXPECT_EQ(with_list("of Jane Doe", "Gated SA"), Attenuation::unknown);
}

TEST_F(DicomFile, OrdersFramesByTheirVectorsAndNeverByPosition) {
  std::vector<std::size_t> order(20);
  std::iota(order.begin(), order.end(), 0);
  test::Dice dice{7};
  for (int round = 0; round < 5; ++round) {
    for (std::size_t n = order.size(); n > 1; --n) std::swap(order[n - 1], order[dice(n)]);
    test::expect_l_shape(read_study(changed([&](DcmDataset& d) { test::reorder_frames(d, order); })), truth,
                         decimal_tolerance_mm);
  }
}

TEST_F(DicomFile, ReadsEveryUnpackedSyntaxAndRunLengths) {
  for (const E_TransferSyntax syntax :
       {EXS_LittleEndianImplicit, EXS_LittleEndianExplicit, EXS_BigEndianExplicit, EXS_RLELossless}) {
    const Study back = read_study(changed([](DcmDataset&) {}, syntax));
    test::expect_l_shape(back, truth, decimal_tolerance_mm);
    EXPECT_EQ(back.time_ms, truth.time_ms);
  }
}

TEST_F(DicomFile, ReadsAFileWithoutPreamble) {
  for (const E_TransferSyntax syntax : {EXS_LittleEndianImplicit, EXS_LittleEndianExplicit}) {
    test::edit_dicom(
        written(truth), scratch / "bare.dcm", [](DcmDataset&) {}, syntax, EWM_dataset);
    test::expect_l_shape(read_study(scratch / "bare.dcm"), truth, decimal_tolerance_mm);
  }
}

TEST_F(DicomFile, NamesTheToolThatConvertsAPackedFile) {
  test::edit_dicom(
      written(truth), scratch / "deflated.dcm", [](DcmDataset&) {}, EXS_DeflatedLittleEndianExplicit);
  EXPECT_THAT(test::refusal_of(scratch / "deflated.dcm"), HasSubstr("dcmconv +te"));
  if (std::system("command -v dcmcjpeg > /dev/null") != 0) GTEST_SKIP() << "dcmcjpeg (package dcmtk) is not installed";
  const std::string pack = "dcmcjpeg " + written(truth).string() + " " + (scratch / "jpeg.dcm").string();
  ASSERT_EQ(std::system(pack.c_str()), 0);
  EXPECT_THAT(test::refusal_of(scratch / "jpeg.dcm"), HasSubstr("dcmdjpeg"));
}

TEST_F(DicomFile, ToleratesDatesOfTheOldForm) {
  const auto file = changed([](DcmDataset& d) {
    put(d, DCM_AcquisitionDate, "1993.11.24");
    put(d, DCM_ContentTime, "11:14:39");
  });
  test::expect_l_shape(read_study(file), truth, decimal_tolerance_mm);
}

TEST_F(DicomFile, FindsThePlaceAtTheRootToo) {
  const auto file = changed([](DcmDataset& d) {
    DcmItem& detector = item_of(d, DCM_DetectorInformationSequence);
    for (const DcmTagKey& tag : {DCM_ImagePositionPatient, DCM_ImageOrientationPatient}) {
      OFString value;
      test::check(detector.findAndGetOFStringArray(tag, value));
      put(d, tag, value.c_str());
      drop(detector, tag);
    }
  });
  test::expect_l_shape(read_study(file), truth, decimal_tolerance_mm);
}

TEST_F(DicomFile, CountsSlicesThenGatesWhenVectorsAreAbsent) {
  for (const bool keep_counts : {true, false}) {
    const auto file = changed([&](DcmDataset& d) {
      for (const DcmTagKey& tag : {DCM_RRIntervalVector, DCM_TimeSlotVector, DCM_SliceVector}) drop(d, tag);
      if (!keep_counts) drop(d, DCM_NumberOfTimeSlots);
    });
    const Study back = read_study(file);
    test::expect_l_shape(back, truth, decimal_tolerance_mm);
    EXPECT_TRUE(has_note(back, "dicom.no_frame_vectors"));
  }
  EXPECT_THAT(refusal([](DcmDataset& d) {
                drop(d, DCM_TimeSlotVector);
                drop(d, DCM_SliceVector);
                put(d, DCM_NumberOfSlices, std::vector<Uint16>{6});
              }),
              HasSubstr("20 frames are not 4 gates of 6 slices"));
}

TEST_F(DicomFile, KeepsTheIntervalWithMostAcceptedBeats) {
  // Five slices, two gates, two R-R intervals: the four gates of the truth under other names.
  const auto file = changed([](DcmDataset& d) {
    std::vector<Uint16> rr, slot;
    for (Uint16 n = 0; n < 20; ++n) {
      rr.push_back(n / 10 + 1);
      slot.push_back(n / 5 % 2 + 1);
    }
    put(d, DCM_RRIntervalVector, rr);
    put(d, DCM_TimeSlotVector, slot);
    put(d, DCM_NumberOfRRIntervals, std::vector<Uint16>{2});
    put(d, DCM_NumberOfTimeSlots, std::vector<Uint16>{2});
    DcmItem& gated = item_of(d, DCM_GatedInformationSequence);
    put(item_of(gated, DCM_DataInformationSequence, 0), DCM_IntervalsAcquired, "200");
    DcmItem& second = item_of(gated, DCM_DataInformationSequence, -2);
    put(second, DCM_IntervalsAcquired, "700");
    put(second, DCM_FrameTime, "450");
  });
  const Study back = read_study(file);
  ASSERT_EQ(back.gates.size(), 2u);
  EXPECT_EQ(back.gates[0].values, truth.gates[2].values);
  EXPECT_EQ(back.gates[1].values, truth.gates[3].values);
  EXPECT_EQ(back.cycle_ms, 900);
  ASSERT_TRUE(has_note(back, "dicom.rr_intervals"));
  EXPECT_THAT(back.notes[0].message, HasSubstr("number 2 is read, with the most accepted beats (700)"));
}

TEST_F(DicomFile, ReadsVectorsThatCountFromZero) {
  const auto less_one = [](DcmDataset& d, const DcmTagKey& tag) {
    auto entries = words_of(d, tag);
    for (Uint16& entry : entries) --entry;
    put(d, tag, entries);
  };
  for (const bool is_declared : {true, false}) {
    const Study back = read_study(changed([&](DcmDataset& d) {
      for (const DcmTagKey& tag : {DCM_RRIntervalVector, DCM_TimeSlotVector, DCM_SliceVector}) less_one(d, tag);
      if (!is_declared)
        for (const DcmTagKey& tag : {DCM_NumberOfTimeSlots, DCM_NumberOfSlices, DCM_NumberOfRRIntervals}) drop(d, tag);
    }));
    test::expect_l_shape(back, truth, decimal_tolerance_mm);
    EXPECT_EQ(back.time_ms, truth.time_ms);
    ASSERT_EQ(back.notes.size(), 3u);
    EXPECT_THAT(back.notes[2].message, HasSubstr("SliceVector counts from 0"));
  }
  // One vector alone may count otherwise than the others.
  const Study back = read_study(changed([&](DcmDataset& d) { less_one(d, DCM_SliceVector); }));
  test::expect_l_shape(back, truth, decimal_tolerance_mm);
  ASSERT_EQ(back.notes.size(), 1u);
  EXPECT_EQ(back.notes[0].code, "dicom.counts_from_zero");
}

/// The study of the truth and after it, frame by frame, another energy window with twice the counts or, dim, a quarter.
void add_energy_window(DcmDataset& d, bool is_dim) {
  const std::size_t frames = words_of(d, DCM_SliceVector).size();
  for (const DcmTagKey& tag : {DCM_RRIntervalVector, DCM_TimeSlotVector, DCM_SliceVector}) {
    auto entries = words_of(d, tag);
    entries.insert(entries.end(), entries.begin(), entries.begin() + static_cast<std::ptrdiff_t>(frames));
    put(d, tag, entries);
  }
  auto pixels = words_of(d, DCM_PixelData);
  const std::size_t count = pixels.size();
  for (std::size_t n = 0; n < count; ++n) pixels.push_back(static_cast<Uint16>(is_dim ? pixels[n] / 4 : 2 * pixels[n]));
  put(d, DCM_PixelData, pixels);
  std::vector<Uint16> window(frames, 1);
  window.resize(2 * frames, 2);
  put(d, DCM_EnergyWindowVector, window);
  put(d, DCM_NumberOfFrames, std::to_string(2 * frames));
}

void put_range(DcmDataset& d, int window, const char* lower, const char* upper) {
  DcmItem& item = item_of(d, DCM_EnergyWindowInformationSequence, window);
  DcmItem& range = item_of(item, DCM_EnergyWindowRangeSequence);
  put(range, DCM_EnergyWindowLowerLimit, lower);
  put(range, DCM_EnergyWindowUpperLimit, upper);
}

TEST_F(DicomFile, ReadsThePhotopeakOfSeveralEnergyWindows) {
  // The scatter window has more counts, and the file says which is which.
  const Study peak = read_study(changed([](DcmDataset& d) {
    add_energy_window(d, false);
    put_range(d, 0, "126.5", "154.5");
    put_range(d, 1, "92", "125");
  }));
  test::expect_l_shape(peak, truth, decimal_tolerance_mm);
  EXPECT_EQ(peak.time_ms, truth.time_ms);
  ASSERT_EQ(peak.notes.size(), 1u);
  EXPECT_EQ(peak.notes[0].code, "dicom.energy_windows");
  EXPECT_THAT(peak.notes[0].message, HasSubstr("number 1 is read, that of the photopeak (126.5 to 154.5 keV)"));
  // It does not say.
  const Study bright = read_study(changed([](DcmDataset& d) { add_energy_window(d, true); }));
  test::expect_l_shape(bright, truth, decimal_tolerance_mm);
  EXPECT_THAT(bright.notes.at(0).message, HasSubstr("number 1 is read, with the most counts"));
  // Thallium is seen at 71 keV, here in the second window, without counts of slices and gates.
  const Study thallium = read_study(changed([](DcmDataset& d) {
    add_energy_window(d, false);
    put_range(d, 0, "150", "185");
    put_range(d, 1, "61", "82");
    DcmItem& nuclide = item_of(item_of(d, DCM_RadiopharmaceuticalInformationSequence), DCM_RadionuclideCodeSequence);
    put(nuclide, DCM_CodeValue, "C-138A9");
    put(nuclide, DCM_CodingSchemeDesignator, "SRT");
    put(nuclide, DCM_CodeMeaning, "201^Thallium");
    for (const DcmTagKey& tag : {DCM_NumberOfTimeSlots, DCM_NumberOfSlices}) drop(d, tag);
  }));
  ASSERT_EQ(thallium.gates.size(), 4u);
  EXPECT_EQ(thallium.gates[1].values[40], 2 * truth.gates[1].values[40]);
  EXPECT_THAT(thallium.notes.at(0).message, HasSubstr("number 2 is read"));
}

TEST_F(DicomFile, ReadsSignedValuesFewBitsAndRescaling) {
  const std::size_t pixels = truth.grid().size() * 4;
  const auto first_of = [&](const std::function<void(DcmDataset&)>& change) {
    const auto values = read_study(changed(change)).gates[0].values;
    return std::vector<float>(values.begin(), values.begin() + 3);
  };
  const auto put_pixels = [&](DcmDataset& d, std::vector<Uint16> values) {
    values.resize(pixels);
    put(d, DCM_PixelData, values);
  };
  using Values = std::vector<float>;
  EXPECT_EQ(first_of([&](DcmDataset& d) {
              put_pixels(d, {0xffff, 0x8000, 0x7fff});
              put(d, DCM_PixelRepresentation, std::vector<Uint16>{1});
            }),
            (Values{-1, -32768, 32767}));
  EXPECT_EQ(first_of([&](DcmDataset& d) { put_pixels(d, {0xffff, 0x8000, 0x7fff}); }), (Values{65535, 32768, 32767}));
  EXPECT_EQ(first_of([&](DcmDataset& d) {  // 12 bits, an overlay in the other four
              put_pixels(d, {0xf001, 0x1fff, 0x2800});
              put(d, DCM_BitsStored, std::vector<Uint16>{12});
              put(d, DCM_HighBit, std::vector<Uint16>{11});
              put(d, DCM_PixelRepresentation, std::vector<Uint16>{1});
            }),
            (Values{1, -1, -2048}));
  EXPECT_EQ(first_of([&](DcmDataset& d) {
              put_pixels(d, {2, 4, 6});
              put(d, DCM_RescaleSlope, "0.5");
              put(d, DCM_RescaleIntercept, "-3");
            }),
            (Values{-2, -1, 0}));
  EXPECT_EQ(first_of([&](DcmDataset& d) {
              put_pixels(d, {2, 4, 6});
              DcmItem& mapping = item_of(d, DCM_RealWorldValueMappingSequence);
              test::check(mapping.putAndInsertFloat64(DCM_RealWorldValueSlope, 0.25));
              test::check(mapping.putAndInsertFloat64(DCM_RealWorldValueIntercept, 1));
            }),
            (Values{1.5, 2, 2.5}));
}

TEST_F(DicomFile, ReadsEightBitPixelsInEverySyntax) {
  for (const E_TransferSyntax syntax :
       {EXS_LittleEndianImplicit, EXS_LittleEndianExplicit, EXS_BigEndianExplicit, EXS_RLELossless}) {
    const auto file = changed(
        [&](DcmDataset& d) {
          std::vector<Uint8> bytes(truth.grid().size() * 4);
          std::iota(bytes.begin(), bytes.end(), Uint8{0});
          for (const auto& [tag, value] : {std::pair{DCM_BitsAllocated, 8}, {DCM_BitsStored, 8}, {DCM_HighBit, 7}})
            put(d, tag, std::vector<Uint16>{static_cast<Uint16>(value)});
          test::check(d.putAndInsertUint8Array(DCM_PixelData, bytes.data(), bytes.size()));
        },
        syntax);
    const Study back = read_study(file);
    for (std::size_t n = 0; n < 200; ++n) ASSERT_EQ(back.gates[0].values[n], static_cast<float>(n));
    ASSERT_EQ(back.gates[1].values[46], 0.f);  // 210 + 46 = 256
  }
}

TEST_F(DicomFile, FallsBackAlongTheKnownPathForTheSliceSpacing) {
  const auto spacing = [&](const std::function<void(DcmDataset&)>& change, bool noted) {
    const Study back = read_study(changed(change));
    EXPECT_EQ(has_note(back, "dicom.slice_spacing"), noted);
    return back.grid().spacing[2];
  };
  EXPECT_DOUBLE_EQ(spacing([](DcmDataset& d) { put(d, DCM_SliceThickness, "7"); }, false), 5.75);
  EXPECT_DOUBLE_EQ(spacing(
                       [](DcmDataset& d) {
                         put(d, DCM_SliceThickness, "7");
                         drop(d, DCM_SpacingBetweenSlices);
                       },
                       true),
                   7);
  EXPECT_DOUBLE_EQ(spacing([](DcmDataset& d) { put(d, DCM_SpacingBetweenSlices, "0"); }, true), 5.75);
  EXPECT_DOUBLE_EQ(spacing(
                       [](DcmDataset& d) {
                         drop(d, DCM_SliceThickness);
                         drop(d, DCM_SpacingBetweenSlices);
                       },
                       true),
                   3.25);
}

TEST_F(DicomFile, TellsTheViewFromCodesThenWords) {
  const auto view = [&](const std::string& code, const std::string& scheme, const std::string& description) {
    return read_study(changed([&](DcmDataset& d) {
             DcmItem& entry = item_of(item_of(d, DCM_DetectorInformationSequence), DCM_ViewCodeSequence);
             put(entry, DCM_CodeValue, code);
             put(entry, DCM_CodingSchemeDesignator, scheme);
             put(d, DCM_SeriesDescription, description);
           }))
        .view;
  };
  EXPECT_EQ(view("G-A186", "SRT", "VLA"), View::short_axis);
  EXPECT_EQ(view("G-A18B", "SRT", ""), View::horizontal_long_axis);
  EXPECT_EQ(view("G-A18A", "SNM3", ""), View::vertical_long_axis);
  EXPECT_EQ(view("131186000", "SCT", ""), View::horizontal_long_axis);
  EXPECT_EQ(view("131185001", "SCT", ""), View::vertical_long_axis);
  EXPECT_EQ(view("X", "99LAB", "Stress Gated SA (AC)"), View::short_axis);
  EXPECT_EQ(view("X", "99LAB", "rest short-axis"), View::short_axis);
  EXPECT_EQ(view("X", "99LAB", "H Long Ax"), View::horizontal_long_axis);
  EXPECT_EQ(view("X", "99LAB", "REST_VLA"), View::vertical_long_axis);
  EXPECT_EQ(view("X", "99LAB", "MPI transaxial"), View::transaxial);
  EXPECT_EQ(view("X", "99LAB", "SA HLA VLA"), View::unknown);
  EXPECT_EQ(view("X", "99LAB", "SATURDAY"), View::unknown);
}

TEST_F(DicomFile, TakesGateTimesFromWhatThereIs) {
  const auto data = [](DcmDataset& d) -> DcmItem& {
    return item_of(item_of(d, DCM_GatedInformationSequence), DCM_DataInformationSequence);
  };
  using Times = std::vector<double>;
  Study s = read_study(changed([&](DcmDataset& d) { drop(data(d), DCM_FrameTime); }));
  EXPECT_EQ(s.time_ms, (Times{0, 200, 400, 600}));
  s = read_study(changed([&](DcmDataset& d) { drop(data(d), DCM_NominalInterval); }));
  EXPECT_EQ(s.cycle_ms, 800);
  s = read_study(changed([&](DcmDataset& d) { put(item_of(d, DCM_GatedInformationSequence), DCM_TriggerTime, "30"); }));
  EXPECT_EQ(s.time_ms, (Times{30, 230, 430, 630}));
  s = read_study(changed([&](DcmDataset& d) {
    drop(d, DCM_GatedInformationSequence);
    put(d, DCM_HeartRate, "60");
  }));
  EXPECT_EQ(s.time_ms, (Times{0, 250, 500, 750}));
  s = read_study(changed([&](DcmDataset& d) { drop(d, DCM_GatedInformationSequence); }));
  EXPECT_TRUE(s.time_ms.empty());
  EXPECT_EQ(s.cycle_ms, 0);
  EXPECT_TRUE(has_note(s, "dicom.no_gate_times"));
}

TEST_F(DicomFile, IsWrittenWithTheSameBytesTwiceAndOtherUidsForOtherContent) {
  write_dicom(truth, scratch / "a.dcm");
  write_dicom(truth, scratch / "b.dcm");
  EXPECT_EQ(test::read_bytes(scratch / "a.dcm"), test::read_bytes(scratch / "b.dcm"));
  const auto uid_of = [](const std::filesystem::path& path) {
    DcmFileFormat file;
    test::check(file.loadFile(path.c_str()));
    OFString uid;
    test::check(file.getDataset()->findAndGetOFString(DCM_SOPInstanceUID, uid));
    return std::string(uid.c_str());
  };
  const std::string uid = uid_of(scratch / "a.dcm");
  EXPECT_THAT(uid, testing::MatchesRegex("2\\.25\\.[1-9][0-9]*"));
  EXPECT_LE(uid.size(), 44u);
  write_dicom(truth, scratch / "b.dcm", {.uid_seed = 1});
  EXPECT_NE(uid_of(scratch / "b.dcm"), uid);
  Study other = truth;
  other.gates[3].values.back() += 1;
  write_dicom(other, scratch / "b.dcm");
  EXPECT_NE(uid_of(scratch / "b.dcm"), uid);
}

TEST_F(DicomFile, IsWrittenRoundedAndScaledOrNotAtAll) {
  Study study = truth;
  study.gates[0].values[0] = 0.26f;
  study.gates[0].values[1] = 10.4f;
  write_dicom(study, scratch / "a.dcm", {.counts_scale = 2});
  const auto values = read_study(scratch / "a.dcm").gates[0].values;
  EXPECT_EQ(values[0], 1);
  EXPECT_EQ(values[1], 21);
  study.gates[0].values[0] = 70000;
  EXPECT_THROW(write_dicom(study, scratch / "b.dcm"), OptionError);
  study.gates[0].values[0] = -1;
  EXPECT_THROW(write_dicom(study, scratch / "b.dcm"), OptionError);
  EXPECT_FALSE(std::filesystem::exists(scratch / "b.dcm"));
}

TEST_F(DicomFile, LeavesNothingPersonalInFactsOrStudy) {
  const auto file = changed([](DcmDataset& d) {
    for (const DcmTagKey& tag :
         {DCM_PatientName, DCM_PatientID, DCM_SeriesDescription, DCM_InstitutionName, DCM_ImageID, DCM_StudyDescription,
          DCM_AccessionNumber, DCM_OperatorsName, DCM_HeartRate, DCM_CorrectedImage, DCM_SeriesType, DCM_ImageComments})
      put(d, tag, "CANARY7");
    put(d, DCM_PatientBirthDate, "19500307");
    DcmItem& tracer = item_of(d, DCM_RadiopharmaceuticalInformationSequence);
    put(tracer, DCM_Radiopharmaceutical, "CANARY7 sestamibi");
    DcmItem& nuclide = item_of(tracer, DCM_RadionuclideCodeSequence);
    put(nuclide, DCM_CodeValue, "C-163A8");
    put(nuclide, DCM_CodeMeaning, "CANARY7");
  });
  const Study study = read_study(file);
  std::string all = study.modality + study.image_type;
  for (const Note& n : study.notes) all += n.message;
  for (const auto& [name, value] : facts_of(file, study).rows) all += name + ": " + value + "\n";
  EXPECT_EQ(all.find("CANARY7"), std::string::npos) << all;
  EXPECT_EQ(all.find("1950"), std::string::npos) << all;
  EXPECT_THAT(all, HasSubstr("isotope: Tc-99m\ntracer: sestamibi"));
  EXPECT_THAT(all, HasSubstr("voxels: 7 x 6 x 5\nvoxel size: 2.5 x 3.25 x 5.75 mm"));
  EXPECT_THAT(all, HasSubstr("gates: 4\nheart cycle: 800 ms (75 /min)\ngates start at: 0 200 400 600 ms"));
}

}  // namespace
}  // namespace dynasurf::io
