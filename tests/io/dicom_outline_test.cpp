#include "dynasurf/io/detail/dicom_outline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

#include "support/dicom_edit.hpp"
#include "support/l_shape.hpp"
#include "support/mutations.hpp"

namespace dynasurf::io {
namespace {

using ::testing::HasSubstr;

/// DICOM by hand: explicit little endian.
std::string word(std::uint32_t value, std::size_t bytes) {
  std::string out;
  for (std::size_t n = 0; n < bytes; ++n) out += static_cast<char>(value >> 8 * n);
  return out;
}
std::string tag(std::uint32_t value) { return word(value >> 16, 2) + word(value & 0xffff, 2); }
std::string element(std::uint32_t which, const std::string& value, const char* vr = "LO") {
  return tag(which) + vr + word(static_cast<std::uint32_t>(value.size()), 2) + value;
}
const std::string endless = word(0xffffffff, 4);
std::string sequence(std::uint32_t which, const std::string& items) {
  return tag(which) + "SQ" + word(0, 2) + endless + items + tag(0xfffee0dd) + word(0, 4);
}
std::string item(const std::string& content) {
  return tag(0xfffee000) + endless + content + tag(0xfffee00d) + word(0, 4);
}
std::string with_meta(const std::string& syntax, const std::string& rest) {
  return std::string(128, '\0') + "DICM" +
         element(0x00020010, syntax + (syntax.size() % 2 ? std::string(1, '\0') : ""), "UI") + rest;
}
const std::string explicit_little = "1.2.840.10008.1.2.1";
constexpr std::uint32_t wanted_sequence = 0x00540022;

class Outline : public ::testing::Test {
 protected:
  test::ScratchFolder scratch;

  DicomOutline outline(const std::string& rest) {
    test::write_bytes(scratch / "a.dcm", with_meta(explicit_little, rest));
    return outline_of_dicom(scratch / "a.dcm", std::vector{wanted_sequence});
  }
  std::string refusal(const std::string& rest) {
    try {
      outline(rest);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(Outline, FindsWhatIsWantedAndNothingElse) {
  const std::string before = element(0x00080008, "ORIGINAL"), inner = item(element(0x00280010, "ab", "US"));
  const DicomOutline found = outline(before + sequence(wanted_sequence, inner) + element(0x7fe00010, "abcd", "US"));
  const std::uint64_t begin = with_meta(explicit_little, before).size();
  ASSERT_EQ(found.wanted.size(), 1u);
  EXPECT_EQ(found.wanted[0].begin, begin);
  EXPECT_EQ(found.wanted[0].size(), sequence(wanted_sequence, inner).size());
}

TEST_F(Outline, TakesPackedPicturesInAnItemForWhatTheyAre) {
  const std::string packed = tag(0x7fe00010) + "OB" + word(0, 2) + endless + tag(0xfffee000) + word(4, 4) + "abcd" +
                             tag(0xfffee0dd) + word(0, 4);
  const DicomOutline found = outline(sequence(0x00880200, item(packed)));
  EXPECT_TRUE(found.fragments.empty());
  EXPECT_FALSE(found.pixels.has_value());
}

TEST_F(Outline, IsRefusedAboveItsLimits) {
  const auto nested = [](std::size_t levels) {
    std::string inner;
    for (std::size_t n = 0; n < levels; ++n) inner = sequence(0x00551010, item(inner));
    return inner;
  };
  EXPECT_EQ(refusal(nested(deepest_dicom_nesting / 2)), "");
  EXPECT_THAT(refusal(nested(deepest_dicom_nesting / 2 + 1)), HasSubstr("nests sequences more than 32 deep"));
  std::string items;
  for (std::uint64_t n = 0; n <= most_nested_elements; ++n) items += item("");
  EXPECT_THAT(refusal(sequence(wanted_sequence, items)), HasSubstr("more than 10000 sequence items"));
  EXPECT_EQ(refusal(sequence(wanted_sequence + 1, items)), "") << "nobody wants these";
  std::string descending;
  for (std::uint32_t n = 1100; n > 0; --n) descending += element(0x00110000 + n, "ab");
  EXPECT_THAT(refusal(sequence(wanted_sequence, item(descending))), HasSubstr("more than 1000 elements that are out"));
  EXPECT_EQ(refusal(descending), "") << "nobody wants these";
  EXPECT_THAT(refusal(sequence(wanted_sequence, "") + sequence(wanted_sequence, "")), HasSubstr("(0054,0022) twice"));
  EXPECT_THAT(refusal(element(0x7fe00010, "ab", "US") + sequence(wanted_sequence, "")),
              HasSubstr("behind its pixel data"));
}

TEST_F(Outline, IsRefusedWhereNoElementCanBe) {
  EXPECT_THAT(refusal(std::string(100, '\0')), HasSubstr("(0000,0000) at byte 160 has no representation"));
  EXPECT_THAT(refusal(element(0x00000010, "ab")), HasSubstr("has no place there"));
  EXPECT_THAT(refusal(element(0x00080008, "ab") + "abc"), HasSubstr("3 bytes"));
  EXPECT_THAT(refusal(element(0x00080008, "abcd").substr(0, 10)), HasSubstr("damaged or cut off"));
  EXPECT_THAT(refusal(tag(wanted_sequence) + "SQ" + word(0, 2) + endless), HasSubstr("damaged or cut off"));
  EXPECT_THAT(refusal(sequence(wanted_sequence, element(0x00080008, "ab"))), HasSubstr("where an item is due"));
}

TEST_F(Outline, NamesASyntaxThatIsNotRead) {
  const auto refused = [&](const std::string& uid) {
    test::write_bytes(scratch / "b.dcm", with_meta(uid, element(0x00080008, "ORIGINAL")));
    return test::refusal_of(scratch / "b.dcm");
  };
  EXPECT_THAT(refused(""), HasSubstr("transfer syntax is not told"));
  EXPECT_THAT(refused("1.2.3.4"), HasSubstr("\"1.2.3.4\""));
  EXPECT_THAT(refused("1.2\x1b[31m"), HasSubstr("\"1.2??31?\""));
  EXPECT_THAT(refused("1.2.840.10008.1.2.4.201"), HasSubstr("High-Throughput JPEG 2000 (1.2.840.10008.1.2.4.201)"));
  EXPECT_THAT(refused("1.2.840.10008.1.2.4.110"), HasSubstr("JPEG XL"));
  EXPECT_THAT(refused("1.2.840.10008.1.2.4.50"), HasSubstr("dcmdjpeg"));
  EXPECT_THAT(refused("1.2.840.10008.1.2.4.80"), HasSubstr("dcmdjpls"));
}

TEST_F(Outline, OfAFileCutBehindItsPixelsIsThatOfTheWholeOne) {
  Grid grid = test::oblique_grid();
  grid.dims = {3, 2, 2};
  write_dicom(test::l_shape_study(grid, 2), scratch / "whole.dcm");
  const std::string image = test::read_bytes(scratch / "whole.dcm");
  const std::string first = image + element(0x7fe10010, "private"), both = first + element(0x7fe11010, "more");
  // Only between two elements, and then nothing is lost that is read.
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.dcm", both), (std::vector<std::size_t>{image.size(), first.size()}));
  test::write_bytes(scratch / "both.dcm", both);
  const Study study = read_study(scratch / "both.dcm"), cut = read_study(scratch / "whole.dcm");
  EXPECT_EQ(study.gates[1].values, cut.gates[1].values);
  EXPECT_EQ(study.time_ms, cut.time_ms);
}

TEST_F(Outline, OfAHugeFileTakesNoTime) {
  const auto path = scratch / "a.dcm";
  test::write_bytes(path, with_meta(explicit_little, element(0x00080008, "ORIGINAL")));
  std::filesystem::resize_file(path, std::uint64_t{3} << 30);
  EXPECT_THAT(test::refusal_of(path), HasSubstr("has no representation"));
}

}  // namespace
}  // namespace dynasurf::io
