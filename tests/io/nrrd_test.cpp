#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/io/detail/gzip.hpp"
#include "dynasurf/io/study_io.hpp"

#include "support/l_shape.hpp"
#include "support/mutations.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using test::write_bytes;
using ::testing::HasSubstr;

constexpr double decimal_tolerance_mm = 1e-9;  // headers hold the shortest text that reads back exactly

class NrrdFile : public ::testing::Test {
 protected:
  test::ScratchFolder scratch;

  std::filesystem::path file(const std::string& bytes, const std::string& name = "study.nrrd") {
    write_bytes(scratch / name, bytes);
    return scratch / name;
  }
  Study read(const std::string& bytes) { return read_study(file(bytes)); }
  std::string refusal(const std::string& bytes) { return test::refusal_of(file(bytes)); }
};

template <class T>
std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string vector_text(const Vec3& v) {
  std::ostringstream out;
  out.precision(17);
  out << "(" << v[0] << "," << v[1] << "," << v[2] << ")";
  return out.str();
}

/// The L by hand: in a named space, gates first or last, raw.
std::string l_file(const Study& study, const std::string& space, const Vec3& from_lps, bool list_first) {
  const Grid& g = study.grid();
  std::string directions, sizes;
  for (int axis = 0; axis < 3; ++axis) {
    directions += " " + vector_text(from_lps.cwiseProduct(Vec3(g.direction.col(axis) * g.spacing[axis])));
    sizes += " " + std::to_string(g.dims[static_cast<std::size_t>(axis)]);
  }
  const std::string count = std::to_string(study.gates.size());
  std::string out =
      "NRRD0004\r\n# by hand\r\ntype: float\r\nDimension: 4\r\nendian: little\r\nencoding: raw\r\nspace: " + space +
      "\r\nsizes:" + (list_first ? " " + count + sizes : sizes + " " + count) +
      "\r\nspace directions:" + (list_first ? " none" + directions : directions + " none") +
      "\r\nspace origin: " + vector_text(from_lps.cwiseProduct(g.origin)) + "\r\n\r\n";
  for (std::size_t n = 0; n < (list_first ? g.size() : 1); ++n)
    for (const Image& image : study.gates) out += list_first ? raw(std::vector{image.values[n]}) : raw(image.values);
  return out;
}

const std::string one_row =
    "NRRD0005\ntype: short\ndimension: 3\nspace: LPS\nsizes: 3 1 1\nspace directions: (2,0,0) (0,2,0) (0,0,2)\n"
    "endian: little\nencoding: raw\nspace origin: (0,0,0)\n";

std::string with(std::string header, const std::string& from, const std::string& to) {
  const auto at = header.find(from);
  if (at == std::string::npos) throw std::logic_error("the header has no " + from);
  return header.replace(at, from.size(), to);
}

TEST_F(NrrdFile, BringsAnAsymmetricObjectBackToItsPlace) {
  for (const bool left_handed : {false, true}) {
    Study truth = test::l_shape_study(test::oblique_grid(left_handed), 4);
    truth.attenuation = left_handed ? Attenuation::corrected : Attenuation::uncorrected;
    write_nrrd(truth, scratch / "l.seq.nrrd");
    const Study back = read_study(scratch / "l.seq.nrrd");
    test::expect_l_shape(back, truth, decimal_tolerance_mm);
    EXPECT_EQ(back.grid().direction.determinant() < 0, left_handed);
    EXPECT_EQ(back.format, "NRRD");
    EXPECT_EQ(back.view, View::short_axis);
    EXPECT_EQ(back.slice_order, SliceOrder::apex_to_base);
    EXPECT_EQ(back.attenuation, truth.attenuation);
    EXPECT_EQ(back.time_ms, truth.time_ms);
    EXPECT_EQ(back.cycle_ms, 800);
  }
}

TEST_F(NrrdFile, ReadsEverySpaceAndBothPlacesOfTheGateAxis) {
  const Study truth = test::l_shape_study(test::oblique_grid(), 3);
  for (const bool list_first : {false, true}) {
    test::expect_l_shape(read(l_file(truth, "left-posterior-superior", {1, 1, 1}, list_first)), truth,
                         decimal_tolerance_mm);
    test::expect_l_shape(read(l_file(truth, "LPS", {1, 1, 1}, list_first)), truth, decimal_tolerance_mm);
    test::expect_l_shape(read(l_file(truth, "right-anterior-superior", {-1, -1, 1}, list_first)), truth,
                         decimal_tolerance_mm);
    test::expect_l_shape(read(l_file(truth, "RAS", {-1, -1, 1}, list_first)), truth, decimal_tolerance_mm);
    test::expect_l_shape(read(l_file(truth, "LAS", {1, -1, 1}, list_first)), truth, decimal_tolerance_mm);
  }
}

TEST_F(NrrdFile, ReadsTypesByteOrdersAndEncodings) {
  const std::string little = raw<std::int16_t>({-2, 0, 258}), big{"\xff\xfe\0\0\x01\x02", 6};
  const std::vector<float> values{-2, 0, 258};
  EXPECT_EQ(read(one_row + "\n" + little).gates[0].values, values);
  EXPECT_EQ(read(with(one_row, "little", "big") + "\n" + big).gates[0].values, values);
  EXPECT_EQ(read(with(one_row, "raw", "gz") + "\n" + gzip(little)).gates[0].values, values);
  EXPECT_EQ(read(with(one_row, "type: short", "type: unsigned char") + "\n\x01\x02\xff").gates[0].values,
            (std::vector<float>{1, 2, 255}));
  EXPECT_EQ(read(with(one_row, "type: short", "type: double") + "\n" + raw<double>({0.5, -1, 1e6})).gates[0].values,
            (std::vector<float>{0.5, -1, 1e6}));
  const std::string longest = raw<std::int64_t>({1, 2, 3});
  for (const std::string sign : {"", "signed ", "unsigned "})
    for (const std::string type : {"long long", "long long int"})
      EXPECT_EQ(read(with(one_row, "type: short", "type: " + sign + type) + "\n" + longest).gates[0].values,
                (std::vector<float>{1, 2, 3}))
          << sign << type;
}

TEST_F(NrrdFile, ReadsADetachedHeader) {
  const std::string data = raw<std::int16_t>({1, 2, 3});
  write_bytes(scratch / "voxels.raw", data);
  const auto header = file(one_row + "data file: voxels.raw\n", "study.nhdr");
  EXPECT_EQ(read_study(header).gates[0].values, (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(files_of_study(header), (std::vector{header, scratch / "voxels.raw"}));
  write_bytes(scratch / "voxels.raw", "line\nxy" + data);
  EXPECT_EQ(read_study(file(one_row + "line skip: 1\nbyte skip: 2\ndata file: voxels.raw\n", "b.nhdr")).gates[0].values,
            (std::vector<float>{1, 2, 3}));
  const auto from_the_end = file(one_row + "byte skip: -1\ndatafile: voxels.raw\n", "c.nhdr");
  EXPECT_THAT(test::refusal_of(from_the_end), HasSubstr("a whole one: 7 if this one is whole"));
  write_bytes(scratch / "voxels.raw", data);
  EXPECT_EQ(read_study(from_the_end).gates[0].values, (std::vector<float>{1, 2, 3}));
  write_bytes(scratch / "voxels.raw", data.substr(1));
  EXPECT_THAT(test::refusal_of(from_the_end), HasSubstr("is cut off"));
  EXPECT_THAT(test::refusal_of(header), HasSubstr("is cut off"));
}

TEST_F(NrrdFile, NeverLeavesTheFolderOfItsHeader) {
  for (const char* name : {"/etc/passwd", "../voxels.raw", "sub/voxels.raw", "..", "LIST", "v%02d.raw 1 3 1"})
    EXPECT_THAT(test::refusal_of(file(one_row + "data file: " + name + "\n", "study.nhdr")), HasSubstr("datafile"))
        << name;
}

TEST_F(NrrdFile, NeverFollowsALinkOutOfTheFolderOfItsHeader) {
  const std::string data = raw<std::int16_t>({1, 2, 3});
  std::filesystem::create_directory(scratch / "other");
  write_bytes(scratch / "other" / "voxels.raw", data);
  const auto header = file(one_row + "data file: link.raw\n", "study.nhdr");
  std::filesystem::create_symlink("other/voxels.raw", scratch / "link.raw");
  EXPECT_THAT(test::refusal_of(header), HasSubstr("leads out of the folder"));
  std::filesystem::remove(scratch / "link.raw");
  write_bytes(scratch / "real.raw", data);
  std::filesystem::create_symlink("real.raw", scratch / "link.raw");
  EXPECT_EQ(test::refusal_of(header), "");
}

TEST_F(NrrdFile, WithADetachedHeaderIsRefusedWhenTheHeaderIsCutAtAnyByte) {
  write_bytes(scratch / "voxels.raw", raw<std::int16_t>({1, 2, 3}));
  const std::string name = "data file: voxels.raw\n";
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.nhdr", one_row + name), std::vector<std::size_t>{});
  // The one exception: programs that leave the empty line out write the name last, so a header may end there.
  const std::string in_front = with(one_row, "endian: little\n", name + "endian: little\n") + "\n";
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.nhdr", in_front), std::vector<std::size_t>{});
  const std::string behind = with(one_row, "space origin", name + "space origin") + "\n";
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.nhdr", behind), std::vector{behind.find("space origin")});
  EXPECT_THAT(test::refusal_of(file(one_row + name + "# no more\ncontent: x\n", "open.nhdr")),
              HasSubstr("ends without a blank line"));
}

TEST_F(NrrdFile, WithADataFileIsRefusedWhenThatIsCutAtAnyByte) {
  for (const char* skip : {"", "byte skip: 3\n", "line skip: 1\n", "byte skip: -1\n"}) {
    const auto header = file(one_row + skip + "data file: voxels.raw\n", "study.nhdr");
    const std::string front = std::string(skip) == "byte skip: 3\n" ? "abc" : *skip == 'l' ? "abc\n" : "";
    const std::string data = front + raw<std::int16_t>({1, 2, 3});
    write_bytes(scratch / "voxels.raw", data);
    ASSERT_EQ(test::refusal_of(header), "") << skip;
    for (std::size_t n = 0; n < data.size(); ++n) {
      write_bytes(scratch / "voxels.raw", data.substr(0, n));
      EXPECT_NE(test::refusal_of(header), "") << skip << n;
    }
  }
}

TEST_F(NrrdFile, TakesTimesOnlyWithTheirUnit) {
  const std::string header =
      "NRRD0005\ntype: uchar\ndimension: 4\nspace: LPS\nsizes: 1 1 1 3\nspace directions: (2,0,0) (0,2,0) (0,0,2) "
      "none\n"
      "encoding: raw\nspace origin: (0,0,0)\naxis 3 index values:=0 0.25 0.5\n";
  EXPECT_TRUE(read(header + "\nabc").time_ms.empty());
  const Study timed = read(header + "units: \"\" \"\" \"\" \"s\"\n\nabc");
  EXPECT_EQ(timed.time_ms, (std::vector<double>{0, 250, 500}));
  EXPECT_EQ(timed.cycle_ms, 750);
  const Study uneven = read(with(header, "0.25", "0.125") + "units: \"\" \"\" \"\" \"s\"\n\nabc");
  EXPECT_EQ(uneven.time_ms, (std::vector<double>{0, 125, 500}));
  EXPECT_EQ(uneven.cycle_ms, 0);
}

TEST_F(NrrdFile, IsRefusedWhenCutAtAnyByte) {
  Grid grid = test::oblique_grid();
  grid.dims = {3, 2, 2};
  write_nrrd(test::l_shape_study(grid, 2), scratch / "whole.nrrd");
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.nrrd", test::read_bytes(scratch / "whole.nrrd")),
            std::vector<std::size_t>{});
  EXPECT_EQ(test::accepted_cuts(scratch / "cut.nrrd", one_row + "\n" + raw<std::int16_t>({1, 2, 3})),
            std::vector<std::size_t>{});
}

TEST_F(NrrdFile, IsRefusedWithTheReason) {
  const std::string data = raw<std::int16_t>({1, 2, 3});
  const auto changed = [&](const std::string& from, const std::string& to) {
    return refusal(with(one_row, from, to) + "\n" + data);
  };
  EXPECT_THAT(refusal(one_row + "\n" + data + "x"), HasSubstr("more data"));
  EXPECT_THAT(changed("3 1 1", "3 1 0"), HasSubstr("is empty"));
  EXPECT_THAT(changed("3 1 1", "1024 1024 1024"), HasSubstr("at most 2048 MiB"));
  EXPECT_THAT(changed("3 1 1", "18446744073709551615 3 1"), HasSubstr("at most 2048 MiB"));
  EXPECT_THAT(changed("3 1 1", "800 800 800"), HasSubstr("is cut off"));
  EXPECT_THAT(changed("3 1 1", "3 1"), HasSubstr("sizes"));
  EXPECT_THAT(changed("dimension: 3", "dimension: 2"), HasSubstr("dimension"));
  EXPECT_THAT(changed("type: short", "type: block"), HasSubstr("type"));
  EXPECT_THAT(changed("endian: little\n", ""), HasSubstr("endian"));
  EXPECT_THAT(changed("raw", "bzip2"), HasSubstr("expected raw or gzip"));
  EXPECT_THAT(changed("raw", "ascii"), HasSubstr("unu save"));
  EXPECT_THAT(changed("LPS", "scanner-xyz"), HasSubstr("space"));
  EXPECT_THAT(changed("(0,2,0)", "(1,2,0)"), HasSubstr("right angles"));
  EXPECT_THAT(changed("(0,2,0)", "(0,nan,0)"), HasSubstr("finite"));
  EXPECT_THAT(changed("(0,2,0)", "none"), HasSubstr("spacedirections"));
  EXPECT_THAT(changed("NRRD0005", "NRRD0009"), HasSubstr("version 1 to 5"));
  EXPECT_THAT(changed("encoding: raw\n", "encoding: raw\nencoding: raw\n"), HasSubstr("twice"));
  EXPECT_THAT(changed("encoding: raw\n", "encoding: raw\nkinds: vector domain domain\n"), HasSubstr("kinds"));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(refusal(with(one_row, "short", "float") + "\n" + raw<float>({1, nan, nan})),
              HasSubstr("voxel (1,0,0) of gate 1 is not a finite number; expected counts (2 of 3 voxels are not)"));
}

/// A file as Slicer writes it: 4 x 1 x 1 voxels, the layers of a voxel side by side.
std::string segmentation(const std::string& layers, const std::string& keys, const std::vector<unsigned char>& voxels) {
  const bool several = !layers.empty();
  return std::string("NRRD0004\n# Complete NRRD file format specification at:\ntype: unsigned char\n") +
         "dimension: " + (several ? "4" : "3") + "\nspace: left-posterior-superior\nsizes: " + layers +
         " 4 1 1\nspace directions: " + (several ? "none " : "") + "(2,0,0) (0,2,0) (0,0,2)\n" +
         "kinds: " + (several ? "list " : "") + "domain domain domain\nencoding: raw\nspace origin: (1,2,3)\n" + keys +
         "Segmentation_ContainedRepresentationNames:=Binary labelmap|\n"
         "Segmentation_MasterRepresentation:=Binary labelmap\n\n" +
         raw(voxels);
}

std::string segment(int number, const std::string& layer, const std::string& value) {
  const std::string name = "Segment" + std::to_string(number);
  return name + "_Color:=0.5 0.7 0.1\n" + name + "_Extent:=0 3 0 0 0 0\n" + name + "_ID:=Segment_1\n" +
         (value.empty() ? "" : name + "_LabelValue:=" + value + "\n") +
         (layer.empty() ? "" : name + "_Layer:=" + layer + "\n") + name + "_Name:=Meier Hans\n" + name +
         "_Tags:=TerminologyEntry:Segmentation category and type - 3D Slicer General Anatomy list~SCT^123~|\n";
}

TEST_F(NrrdFile, OfSlicersSegmentationsIsALabelMap) {
  using Values = std::vector<float>;
  const Study one = read(segmentation("", segment(0, "0", "1") + segment(1, "0", "7"), {0, 1, 7, 1}));
  EXPECT_EQ(one.gates.at(0).values, (Values{0, 1, 7, 1}));
  ASSERT_EQ(one.notes.size(), 1u);
  EXPECT_EQ(one.notes[0].code, "nrrd.segmentation");
  EXPECT_THAT(one.notes[0].message, HasSubstr("a segmentation of 2 segments, a label map"));
  EXPECT_EQ(one.notes[0].message.find("Meier"), std::string::npos);

  // Two layers, which are no gates of a beat; values of their own are kept, the later segment on top.
  const Study own = read(segmentation("2", segment(0, "0", "3") + segment(1, "1", "5"), {3, 0, 3, 5, 0, 5, 0, 0}));
  ASSERT_EQ(own.gates.size(), 1u);
  EXPECT_EQ(own.gates[0].values, (Values{3, 5, 5, 0}));
  EXPECT_EQ(own.notes.size(), 1u);
  const Study same = read(segmentation("2", segment(0, "1", "1") + segment(1, "0", "1"), {1, 1, 0, 1, 1, 0, 0, 0}));
  EXPECT_EQ(same.gates.at(0).values, (Values{2, 1, 2, 0}));
  EXPECT_THAT(same.notes.at(0).message, HasSubstr("numbered from 1"));
  // Before 2020: a layer each, without values.
  const Study old = read(segmentation("2", segment(0, "", "") + segment(1, "", ""), {1, 0, 1, 1, 0, 1, 0, 0}));
  EXPECT_EQ(old.gates.at(0).values, (Values{1, 2, 2, 0}));

  EXPECT_THAT(refusal(segmentation("", segment(0, "1", "1"), {0, 1, 7, 1})),
              HasSubstr("NRRD key Segment0_Layer is \"1\"; expected 0 to 0"));
  EXPECT_THAT(refusal(segmentation("", segment(0, "0", "one"), {0, 1, 7, 1})), HasSubstr("Segment0_LabelValue"));
}

TEST_F(NrrdFile, SurvivesFlippedBits) {
  Grid grid = test::oblique_grid();
  grid.dims = {3, 2, 2};
  write_nrrd(test::l_shape_study(grid, 2), scratch / "whole.nrrd");
  EXPECT_GT(test::refused_of_flipped(scratch / "f.nrrd", test::read_bytes(scratch / "whole.nrrd"), 4000, 3), 1500);
}

}  // namespace
}  // namespace dynasurf::io
