#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/dicom_edit.hpp"
#include "support/l_shape.hpp"
#include "support/mutations.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;
using test::item_of;
using test::put;
using ::testing::HasSubstr;

constexpr double position_tolerance_mm = 1e-6;  // positions are written with eight decimals

class DicomFolder : public ::testing::Test {
 protected:
  test::ScratchFolder scratch;
  const Study truth = test::l_shape_study(test::oblique_grid(), 4);
  const fs::path folder = scratch / "study";

  void write_pet(const std::function<void(DcmDataset&, int)>& tell_gate) {
    test::write_single_frames(truth, folder, tell_gate);
  }
  static void tell_trigger(DcmDataset& d, int gate) { put(d, DCM_TriggerTime, std::to_string(200 * gate)); }

  /// One file of all slices per gate.
  void write_gates(const std::function<void(DcmDataset&, int)>& tell_gate) {
    fs::create_directories(folder);
    for (int g = 0; g < 4; ++g) {
      Study one = truth;
      one.gates = {truth.gates[static_cast<std::size_t>(g)]};
      one.time_ms.clear();
      write_dicom(one, scratch / "one.dcm");
      test::edit_dicom(scratch / "one.dcm",
                       folder / ("f" + std::to_string((7 - 3 * g) % 5 + 5) + std::to_string(g) + ".dcm"),
                       [&](DcmDataset& d) {
                         put(d, DCM_StudyInstanceUID, "2.25.1");
                         tell_gate(d, g);
                       });
    }
  }
  fs::path some_file() const { return *fs::directory_iterator(folder); }
};

TEST_F(DicomFolder, OfOneFilePerSliceAndGateIsSortedByPlaceAndTime) {
  write_pet(tell_trigger);
  const Study back = read_study(folder);
  test::expect_l_shape(back, truth, position_tolerance_mm);
  EXPECT_EQ(back.time_ms, truth.time_ms);
  EXPECT_EQ(back.cycle_ms, 800);
  EXPECT_EQ(back.modality, "PT");
  EXPECT_TRUE(back.notes.empty());
  EXPECT_EQ(files_of_study(folder).size(), 20u);
  EXPECT_THAT(facts_of(folder, back).rows, testing::Contains(std::pair<std::string, std::string>("gates", "4")));
}

TEST_F(DicomFolder, FindsGatesByEveryAttributeThatTellsThem) {
  const std::function<void(DcmDataset&, int)> ways[] = {
      [](DcmDataset& d, int g) { put(d, DCM_TemporalPositionIdentifier, std::to_string(g + 1)); },
      [](DcmDataset& d, int g) {
        test::check(d.putAndInsertUint32(DCM_TemporalPositionIndex, static_cast<Uint32>(g + 1)));
      },
      [](DcmDataset& d, int g) {
        test::check(d.putAndInsertFloat32(DCM_NominalPercentageOfCardiacPhase, 25.0f * static_cast<float>(g)));
      },
      [](DcmDataset& d, int g) {  // a series per gate
        put(d, DCM_SeriesInstanceUID, "2.25." + std::to_string(70 - g));
        put(d, DCM_TriggerTime, std::to_string(200 * g));
      },
      [](DcmDataset& d, int g) {
        put(d, DCM_SeriesInstanceUID, "2.25." + std::to_string(70 - g));
        put(d, DCM_SeriesDescription, "AC Gate " + std::to_string(g + 1));
      }};
  for (const auto& way : ways) {
    fs::remove_all(folder);
    write_pet(way);
    test::expect_l_shape(read_study(folder), truth, position_tolerance_mm);
  }
}

TEST_F(DicomFolder, WithOnlyInstanceNumbersIsReadWithAWarning) {
  write_pet([](DcmDataset&, int) {});
  const Study back = read_study(folder);
  test::expect_l_shape(back, truth, position_tolerance_mm);
  ASSERT_EQ(back.notes.size(), 1u);
  EXPECT_EQ(back.notes[0].code, "dicom.gate_order");
  EXPECT_EQ(back.notes[0].severity, Severity::warning);
}

TEST_F(DicomFolder, OfOneFilePerGateIsJoined) {
  const std::function<void(DcmDataset&, int)> ways[] = {
      [](DcmDataset& d, int g) { put(d, DCM_TriggerTime, std::to_string(200 * g)); },
      [](DcmDataset& d, int g) { put(d, DCM_SeriesDescription, "SA bin " + std::to_string(g + 1)); },
      [](DcmDataset& d, int g) {
        put(d, DCM_ImageType, "DERIVED\\PRIMARY\\RECON GATED TOMO\\EMISSION");
        put(d, DCM_TimeSlotVector, std::vector<Uint16>(5, static_cast<Uint16>(g)));  // counted from 0
        put(d, DCM_NumberOfTimeSlots, std::vector<Uint16>{4});
      },
      [](DcmDataset& d, int g) {
        put(d, DCM_ImageType, "DERIVED\\PRIMARY\\RECON GATED TOMO\\EMISSION");
        put(d, DCM_TimeSlotVector, std::vector<Uint16>(5, static_cast<Uint16>(g + 1)));
        put(d, DCM_NumberOfTimeSlots, std::vector<Uint16>{4});
      }};
  for (const auto& way : ways) {
    fs::remove_all(folder);
    write_gates(way);
    test::expect_l_shape(read_study(folder), truth, position_tolerance_mm);
  }
  // The last way names its gates, so one of them alone is known to be incomplete, and a lost one is missed.
  EXPECT_THAT(test::refusal_of(some_file()), HasSubstr("of 4 only"));
  fs::remove(some_file());
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("a gate is missing"));
}

TEST_F(DicomFolder, OfEqualStacksThatNothingTellsApartIsRefused) {
  write_gates([](DcmDataset&, int) {});  // rest, stress, corrected, uncorrected: not a heart beat
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("holds 4 different image stacks"));
}

TEST_F(DicomFolder, SkipsWhatIsNotDicomAndSaysSo) {
  write_pet(tell_trigger);
  test::write_bytes(folder / "README.txt", "hello");
  test::write_bytes(folder / "empty", "");
  test::write_bytes(folder / "looks", std::string("\x08\0\0\0nonsense", 12));
  const Study back = read_study(folder);
  test::expect_l_shape(back, truth, position_tolerance_mm);
  ASSERT_EQ(back.notes.size(), 1u);
  EXPECT_THAT(back.notes[0].message, HasSubstr("3 files of the folder are not part of the study"));
}

TEST_F(DicomFolder, OfJunkIsRefused) {
  fs::create_directories(folder);
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("holds no DICOM image"));
  test::write_bytes(folder / "README.txt", "hello");
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("holds no DICOM image"));
}

TEST_F(DicomFolder, WithADamagedSliceIsRefused) {
  write_pet(tell_trigger);
  const std::string bytes = test::read_bytes(some_file());
  test::write_bytes(some_file(), bytes.substr(0, bytes.size() - 10));
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("damaged or cut off"));
}

TEST_F(DicomFolder, WithMissingOrDoubleFilesIsRefused) {
  write_pet(tell_trigger);
  const fs::path file = some_file();
  const std::string bytes = test::read_bytes(file);
  fs::remove(file);
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("a file is missing or double"));
  test::write_bytes(file, bytes);
  test::edit_dicom(file, folder / "copy", [](DcmDataset& d) { put(d, DCM_TriggerTime, "37"); });
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("is there twice"));
  test::edit_dicom(file, folder / "copy", [](DcmDataset& d) { put(d, DCM_SOPInstanceUID, "2.25.5"); });
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("a file is missing or double"));
}

TEST_F(DicomFolder, WithTheSameFilesTwiceIsReadWithANote) {
  write_pet(tell_trigger);
  const fs::path file = some_file();
  test::write_bytes(folder / "zz_copy", test::read_bytes(file));
  test::edit_dicom(
      file, folder / "zz_packed", [](DcmDataset&) {}, EXS_RLELossless);
  const Study back = read_study(folder);
  test::expect_l_shape(back, truth, position_tolerance_mm);
  ASSERT_EQ(back.notes.size(), 1u);
  EXPECT_EQ(back.notes[0].code, "dicom.copies");
  EXPECT_THAT(back.notes[0].message, HasSubstr("2 files"));
  EXPECT_EQ(files_of_study(folder).size(), 20u);
  fs::remove_all(folder);
  fs::create_directories(folder / "export again");
  write_dicom(truth, folder / "sa.dcm");
  fs::copy(folder / "sa.dcm", folder / "export again/sa.dcm");
  test::expect_l_shape(read_study(folder), truth, position_tolerance_mm);
}

TEST_F(DicomFolder, WithAGapBetweenSlicesIsRefused) {
  Study one = truth;
  one.gates.resize(1);
  test::write_single_frames(one, folder, [](DcmDataset&, int) {});
  test::expect_l_shape(read_study(folder), one, position_tolerance_mm);
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename().string().ends_with("_2")) fs::remove(entry.path());
  // The place is named, not the slices that are there: those numbered 2 and 3 now were 2 and 4.
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("slices 2 and 3 of 4, at "));
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("are 11.50 mm apart, the others 5.75 mm; a slice is missing at "));
}

TEST_F(DicomFolder, WithoutItsFirstOrLastSliceIsRefusedWhenACountTells) {
  Study one = truth;
  one.gates.resize(1);
  const std::pair<const char*, std::function<void(DcmDataset&)>> counts[] = {
      {"holds 4 of 5 slices that NumberOfSlices tells",
       [](DcmDataset& d) { put(d, DCM_NumberOfSlices, std::vector<Uint16>{5}); }},
      {"holds 4 of 5 images that ImagesInAcquisition tells",
       [](DcmDataset& d) { put(d, DCM_ImagesInAcquisition, "5"); }}};
  for (const auto& [reason, count] : counts)
    for (const char* lost : {"_0", "_4"})
      for (const bool derived : {false, true}) {
        fs::remove_all(folder);
        test::write_single_frames(one, folder, [&, &put_count = count](DcmDataset& d, int) {
          put_count(d);
          if (derived) put(d, DCM_ImageType, "DERIVED\\PRIMARY");
        });
        test::expect_l_shape(read_study(folder), one, position_tolerance_mm);
        for (const auto& entry : fs::directory_iterator(folder))
          if (entry.path().filename().string().ends_with(lost)) fs::remove(entry.path());
        if (!derived) {
          EXPECT_THAT(test::refusal_of(folder), HasSubstr(reason));
          continue;
        }
        const Study back = read_study(folder);
        EXPECT_THAT(back.notes.at(0).message, HasSubstr(reason));
        EXPECT_EQ(back.notes.at(0).code, "dicom.fewer_images");
      }
}

TEST_F(DicomFolder, NumberedFromLaterThanOneIsReadWithANote) {
  Study one = truth;
  one.gates.resize(1);
  test::write_single_frames(one, folder, [](DcmDataset&, int) {});
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename().string().ends_with("_0")) fs::remove(entry.path());
  const Study back = read_study(folder);
  ASSERT_EQ(back.notes.size(), 1u);
  EXPECT_EQ(back.notes[0].code, "dicom.first_number");
}

TEST_F(DicomFolder, WithoutOneOfItsGatesIsRefusedWhenTheirNumberTells) {
  write_pet([](DcmDataset& d, int gate) {
    tell_trigger(d, gate);
    put(d, DCM_NumberOfTimeSlots, std::vector<Uint16>{4});
  });
  test::expect_l_shape(read_study(folder), truth, position_tolerance_mm);
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (std::stoi(name.substr(name.find('_') + 1)) >= 15) fs::remove(entry.path());
  }
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("holds 3 of 4 gates that NumberOfTimeSlots tells"));
}

TEST_F(DicomFolder, TakesTheOnlyGatedShortAxisOfSeveralStacksAndSaysSo) {
  fs::create_directories(folder / "deeper");
  write_dicom(truth, folder / "deeper/sa.dcm");
  Study other = truth;
  other.view = View::vertical_long_axis;
  write_dicom(other, folder / "vla.dcm");
  other.gates.resize(1);
  other.view = View::short_axis;
  write_dicom(other, folder / "ungated.dcm");
  test::edit_dicom(folder / "vla.dcm", folder / "raw.dcm",
                   [](DcmDataset& d) { put(d, DCM_ImageType, "ORIGINAL\\PRIMARY\\GATED TOMO\\EMISSION"); });
  const Study back = read_study(folder);
  test::expect_l_shape(back, truth, position_tolerance_mm);
  EXPECT_EQ(back.view, View::short_axis);
  ASSERT_EQ(back.notes.size(), 2u);
  EXPECT_THAT(back.notes[0].message, HasSubstr("holds 3 image stacks"));
  EXPECT_THAT(back.notes[1].message, HasSubstr("1 are images of another kind"));
  EXPECT_EQ(files_of_study(folder), std::vector{folder / "deeper/sa.dcm"});
  write_dicom(test::l_shape_study(test::oblique_grid(true), 4), folder / "second.dcm");
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("holds 4 different image stacks (2 of them"));
}

TEST_F(DicomFolder, OfRestAndStressIsListedUntilASeriesIsChosen) {
  fs::create_directories(folder);
  const Study stress = test::l_shape_study(test::oblique_grid(true), 4);
  const auto write_series = [&](const Study& study, const char* name, const char* number, const char* words) {
    write_dicom(study, scratch / "one.dcm");
    test::edit_dicom(scratch / "one.dcm", folder / name, [&](DcmDataset& d) {
      put(d, DCM_SeriesInstanceUID, std::string("2.25.9") + number);
      put(d, DCM_SeriesNumber, number);
      put(d, DCM_SeriesDescription, words);
    });
  };
  write_series(stress, "a.dcm", "401", "Meier^Hans STRESS gated SA");
  write_series(truth, "b.dcm", "201", "Meier^Hans REST gated SA");
  const std::string line = test::refusal_of(folder);
  EXPECT_THAT(line,
              HasSubstr("holds 2 different image stacks (2 of them gated and perhaps short-axis); choose one with "
                        "--series NUMBER: 201 is 4 gates of 7 x 6 x 5, short axis, rest; 401 is 4 gates of 7 x 6 x "
                        "5, short axis, stress"));
  EXPECT_EQ(line.find("Meier"), std::string::npos) << "free text may name a person";
  for (const char* rest : {"201", "2.25.9201", "rest"}) {
    const Study back = read_study(folder, rest);
    test::expect_l_shape(back, truth, position_tolerance_mm);
    EXPECT_EQ(back.series, "201");
    ASSERT_EQ(back.notes.size(), 1u);
    EXPECT_EQ(back.notes[0].severity, Severity::info);
    EXPECT_THAT(back.notes[0].message, HasSubstr("number 201, which --series chose, is read"));
    EXPECT_EQ(files_of_study(folder, rest), std::vector{folder / "b.dcm"});
  }
  test::expect_l_shape(read_study(folder, "Stress"), stress, position_tolerance_mm);
  EXPECT_THROW(read_study(folder, "2"), InputError);
  EXPECT_THROW(read_study(folder, "gated"), InputError);  // both
  EXPECT_THROW(read_study(folder / "a.dcm", "201"), InputError);
  EXPECT_EQ(read_study(folder / "a.dcm", "401").gates.size(), 4u);
  // Numbers that do not tell series apart give way to the places in the list.
  write_series(stress, "a.dcm", "201", "STRESS");
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("NUMBER: 1 is 4 gates of 7 x 6 x 5, short axis, stress; 2 is"));
  EXPECT_EQ(read_study(folder, "1").series, "1");
}

TEST_F(DicomFolder, OfRestAndStressInAFilePerGateIsJoinedAndListed) {
  write_gates([](DcmDataset& d, int g) { put(d, DCM_SeriesDescription, "REST SA bin " + std::to_string(g + 1)); });
  fs::rename(folder, scratch / "rest");
  write_gates([](DcmDataset& d, int g) { put(d, DCM_SeriesDescription, "STRESS SA bin " + std::to_string(g + 1)); });
  for (const auto& entry : fs::directory_iterator(scratch / "rest"))
    test::edit_dicom(entry.path(), folder / ("r" + entry.path().filename().string()), [&](DcmDataset& d) {
      put(d, DCM_SOPInstanceUID, "2.25.77" + entry.path().stem().string().substr(1));
    });
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("holds 2 different image stacks (2 of them"));
  test::expect_l_shape(read_study(folder, "rest"), truth, position_tolerance_mm);
}

TEST_F(DicomFolder, OfOneFilePerEnergyWindowIsReadFromThePhotopeak) {
  fs::create_directories(folder);
  const auto write_window = [&](const Study& study, const char* name, const char* lower, const char* upper) {
    write_dicom(study, scratch / "one.dcm");
    test::edit_dicom(scratch / "one.dcm", folder / name, [&](DcmDataset& d) {
      put(d, DCM_StudyInstanceUID, "2.25.1");
      DcmItem& range = item_of(item_of(d, DCM_EnergyWindowInformationSequence), DCM_EnergyWindowRangeSequence);
      put(range, DCM_EnergyWindowLowerLimit, lower);
      put(range, DCM_EnergyWindowUpperLimit, upper);
    });
  };
  Study scatter = truth;
  for (Image& gate : scatter.gates)
    for (float& v : gate.values) v *= 2;
  write_window(scatter, "a.dcm", "90", "120");
  write_window(truth, "b.dcm", "126", "154");
  const Study back = read_study(folder);
  test::expect_l_shape(back, truth, position_tolerance_mm);
  EXPECT_THAT(back.notes.at(0).message, HasSubstr("photopeak"));
}

TEST_F(DicomFolder, OfCineWithASeriesPerSliceIsJoined) {
  const auto write_cine = [&](const std::string& word) {
    fs::remove_all(folder);
    write_pet(tell_trigger);
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      const int n = std::stoi(name.substr(name.find('_') + 1)), slice = n % 5;
      test::edit_dicom(entry.path(), scratch / "one", [&](DcmDataset& d) {
        put(d, DCM_SOPClassUID, UID_MRImageStorage);
        put(d, DCM_Modality, "MR");
        put(d, DCM_SeriesInstanceUID, "2.25." + std::to_string(90 - slice));
        put(d, DCM_SeriesNumber, std::to_string(10 + slice));
        put(d, DCM_SeriesDescription, word);
        put(d, DCM_TriggerTime, std::to_string(200 * (n / 5) + slice));  // hearts do not beat evenly
        put(d, DCM_InstanceNumber, std::to_string(n / 5 + 1));
      });
      fs::rename(scratch / "one", entry.path());
    }
  };
  for (const char* word : {"", "cine SAX"}) {
    write_cine(word);
    const Study back = read_study(folder);
    test::expect_l_shape(back, truth, position_tolerance_mm);
    EXPECT_EQ(back.modality, "MR");
    ASSERT_EQ(back.notes.size(), word[0] == 0 ? 1u : 2u);
    EXPECT_THAT(back.notes[0].message, HasSubstr("5 series of one slice each were joined"));
  }
  // A long axis, of another direction, stands beside it in most examinations.
  Study other = test::l_shape_study(test::oblique_grid(), 4);
  for (Image& gate : other.gates) {
    gate.grid.dims[2] = 1;
    gate.grid.direction.col(1).swap(gate.grid.direction.col(2));
    gate.values.resize(gate.grid.size());
  }
  other.view = View::unknown;
  test::write_single_frames(other, scratch / "long", tell_trigger);
  for (const auto& entry : fs::directory_iterator(scratch / "long"))
    test::edit_dicom(entry.path(), folder / ("long" + entry.path().filename().string()), [&](DcmDataset& d) {
      put(d, DCM_SeriesInstanceUID, "2.25.50");
      const std::string name = entry.path().filename().string();
      put(d, DCM_SOPInstanceUID, "2.25.6" + name.substr(name.find('_') + 1));
    });
  const Study back = read_study(folder);
  test::expect_l_shape(back, truth, position_tolerance_mm);
  EXPECT_THAT(back.notes.at(1).message, HasSubstr("the only gated one"));
  // A slice that is missing is still missed.
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name[0] == 'i' && std::stoi(name.substr(name.find('_') + 1)) % 5 == 2) fs::remove(entry.path());
  }
  EXPECT_THAT(test::refusal_of(folder), HasSubstr("a slice is missing"));
}

TEST_F(DicomFolder, OfProjectionsOnlyIsRefusedWithTheirReason) {
  fs::create_directories(folder);
  write_dicom(truth, scratch / "a.dcm");
  test::edit_dicom(scratch / "a.dcm", folder / "raw.dcm",
                   [](DcmDataset& d) { put(d, DCM_ImageType, "ORIGINAL\\PRIMARY\\TOMO\\EMISSION"); });
  try {
    read_study(folder);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("raw.dcm: holds projections (TOMO)"));
  }
}

TEST_F(DicomFolder, OneSingleFrameFileAloneIsOneSlice) {
  write_pet(tell_trigger);
  const Study back = read_study(some_file());
  EXPECT_EQ(back.grid().dims, (Index3{7, 6, 1}));
  EXPECT_EQ(back.notes.at(0).code, "dicom.one_slice");
}

}  // namespace
}  // namespace dynasurf::io
