#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"

#include "support/damage.hpp"
#include "support/e57_writer.hpp"

namespace dynasurf::io {
namespace {

using test::e57_content;
using test::e57_doubles;
using test::e57_file;
using test::e57_integers;
using test::e57_pages;
using test::e57_singles;
using test::E57Scan;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Bytes = std::array<std::uint8_t, 3>;

struct Read {
  PointCloud cloud;
  Notes notes;
};

Read read(std::string_view bytes) {
  Read result;
  CloudSource source;
  result.cloud = detail::decode_cloud({"a.e57", bytes}, source, result.notes);
  EXPECT_EQ(source.format, "E57");
  return result;
}

/// The message with which a file is refused; empty when it is not.
std::string refusal(std::string_view bytes) {
  try {
    read(bytes);
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_THAT(text, testing::StartsWith("a.e57: "));
    EXPECT_EQ(text.find('\n'), text.npos);
    return text;
  }
  return "";
}

const std::string quarter_turn_and_step =
    "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">0.7071067811865476</w><x type=\"Float\"/>"
    "<y type=\"Float\">0</y><z type=\"Float\">7.071067811865476e-1</z></rotation><translation type=\"Structure\">"
    "<x type=\"Float\">10</x><y type=\"Float\">-2.5</y><z type=\"Float\"/></translation></pose>\n";

std::string limits(const std::string& type, const std::string& least, const std::string& most) {
  std::string xml = "<colorLimits type=\"Structure\">";
  for (const char* name : {"colorRed", "colorGreen", "colorBlue"})
    for (const auto& [end, value] : {std::pair{"Minimum", least}, std::pair{"Maximum", most}})
      xml += std::string("<") + name + end + " type=\"" + type + "\">" + value + "</" + name + end + ">";
  return xml + "</colorLimits>\n";
}

/// Three points with coordinates of each kind.
E57Scan three_points() {
  return {{e57_singles("cartesianX", {1, -2.5F, 0}), e57_doubles("cartesianY", {0.1, 1e6, -3}),
           e57_integers("cartesianZ", -100, 1000, {-100, 1000, 7}, "scale=\"0.01\" offset=\"5\"")},
          "",
          512,
          false};
}

TEST(E57, ReadsBackIntegersOfEveryWidthOverAnyPackets) {
  std::mt19937_64 random(1);
  for (unsigned width = 0; width <= 64; ++width) {
    const std::uint64_t most = width == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
    const std::int64_t least = width > 62 ? std::numeric_limits<std::int64_t>::min() : -3;
    std::vector<std::int64_t> values{least, std::bit_cast<std::int64_t>(std::bit_cast<std::uint64_t>(least) + most)};
    const std::int64_t largest = values[1];
    while (values.size() < 200)
      values.push_back(std::bit_cast<std::int64_t>(std::bit_cast<std::uint64_t>(least) + (random() & most)));
    const std::vector<double> others(200, 0.5);
    for (const std::size_t packet : {1, 7, 64, 4000}) {
      const E57Scan scan{{e57_integers("cartesianX", least, largest, values), e57_doubles("cartesianY", others),
                          e57_integers("rowIndex", 0, 5, std::vector<std::int64_t>(200, 5)),
                          e57_integers("cartesianZ", least, largest, values, "scale=\"0.5\" offset=\"-1\"")},
                         "",
                         packet,
                         true};
      const PointCloud cloud = read(e57_file({scan})).cloud;
      ASSERT_EQ(cloud.points.size(), 200u);
      for (std::size_t n = 0; n < 200; ++n) {
        const auto value = static_cast<double>(values[n]);
        ASSERT_EQ(cloud.points[n], Vec3(value, 0.5, value * 0.5 - 1)) << width << " bits, point " << n;
      }
    }
  }
}

TEST(E57, KeepsRealNumbersAsTheyAre) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const E57Scan scan{{e57_singles("cartesianX", {0.1F, -0.0F, 3e38F}), e57_doubles("cartesianY", {0.1, 1e-310, nan}),
                      e57_doubles("cartesianZ", {-1e300, 2, 3})},
                     "",
                     5,
                     false};
  const PointCloud cloud = read(e57_file({scan})).cloud;
  EXPECT_EQ(cloud.points[0], Vec3(0.1F, 0.1, -1e300));
  EXPECT_EQ(cloud.points[1], Vec3(0, 1e-310, 2));
  EXPECT_TRUE(std::isnan(cloud.points[2][1])) << "where a scanner saw nothing";
}

TEST(E57, BringsScansToOneFrame) {
  E57Scan turned = three_points();
  turned.more = quarter_turn_and_step;
  const Read all = read(e57_file({three_points(), turned}));
  EXPECT_THAT(all.cloud.scans, ElementsAre(0, 0, 0, 1, 1, 1));
  EXPECT_EQ(all.cloud.points[0], Vec3(1, 0.1, 4));
  EXPECT_EQ(all.cloud.points[1], Vec3(-2.5, 1e6, 15));
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3& p = all.cloud.points[n];
    EXPECT_LE((all.cloud.points[3 + n] - Vec3(10 - p[1], p[0] - 2.5, p[2])).norm(), 1e-9) << "rounding of 1e6";
  }
  EXPECT_THAT(all.notes, IsEmpty());
  E57Scan empty = three_points();
  for (auto& column : empty.columns) column.values.clear();
  EXPECT_EQ(read(e57_file({empty, turned})).cloud.points.size(), 3u);
  EXPECT_THAT(refusal(e57_file({empty})), HasSubstr("holds no point"));
  EXPECT_THAT(refusal(e57_file({})), HasSubstr("holds no point"));
}

TEST(E57, TellsWhereAScanWasTakenFromByItsPose) {
  const auto moved = [](const std::string& x) {
    E57Scan scan = three_points();
    scan.more =
        "<pose type=\"Structure\"><translation type=\"Structure\"><x type=\"Float\">" + x + "</x></translation></pose>";
    return scan;
  };
  EXPECT_THAT(read(e57_file({moved("0"), moved("4")})).cloud.scanners, ElementsAre(Vec3(0, 0, 0), Vec3(4, 0, 0)));
  EXPECT_THAT(read(e57_file({moved("4")})).cloud.scanners, ElementsAre(Vec3(4, 0, 0)));
  EXPECT_THAT(read(e57_file({moved("0"), moved("0")})).cloud.scanners, IsEmpty()) << "that of points of no scanner";
  EXPECT_THAT(read(e57_file({moved("4"), three_points()})).cloud.scanners, IsEmpty());
  const E57Scan angles{{e57_doubles("sphericalRange", {2, 3, 1}), e57_doubles("sphericalAzimuth", {0, 1, 2}),
                        e57_doubles("sphericalElevation", {0, 0, 0})},
                       "",
                       512,
                       false};
  EXPECT_THAT(read(e57_file({angles})).cloud.scanners, ElementsAre(Vec3(0, 0, 0)));
}

TEST(E57, FollowsAngles) {
  constexpr double pi = std::numbers::pi;
  E57Scan scan{
      {e57_doubles("sphericalRange", {2, 3, 1.5, 9}), e57_doubles("sphericalAzimuth", {0, pi / 2, 0.3, 1}),
       e57_doubles("sphericalElevation", {0, 0, -0.7, 1}), e57_integers("sphericalInvalidState", 0, 2, {0, 0, 0, 1})},
      "",
      512,
      false};
  const Read some = read(e57_file({scan}));
  ASSERT_EQ(some.cloud.points.size(), 3u);
  EXPECT_EQ(some.cloud.points[0], Vec3(2, 0, 0));
  EXPECT_LE((some.cloud.points[1] - Vec3(0, 3, 0)).norm(), 1e-15);
  const Vec3 third = 1.5 * Vec3(std::cos(0.7) * std::cos(0.3), std::cos(0.7) * std::sin(0.3), -std::sin(0.7));
  EXPECT_LE((some.cloud.points[2] - third).norm(), 1e-15);
  ASSERT_EQ(some.notes.size(), 1u);
  EXPECT_EQ(some.notes[0].message, "1 points are marked as invalid and left out");
  // Beside coordinates they say nothing new.
  for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
    scan.columns.push_back(e57_doubles(axis, {1, 2, 3, 4}));
  EXPECT_EQ(read(e57_file({scan})).cloud.points, (std::vector<Vec3>{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}}));
}

TEST(E57, LeavesOutInvalidPointsWithAllTheyHave) {
  E57Scan scan = three_points();
  scan.columns.push_back(e57_integers("cartesianInvalidState", 0, 2, {0, 2, 0}));
  for (const char* name : {"colorRed", "colorGreen", "colorBlue"})
    scan.columns.push_back(e57_integers(name, 0, 255, {10, 20, 30}));
  const double slant[] = {1, 0, 0.6};
  for (std::size_t a = 0; a < 3; ++a)
    scan.columns.push_back(e57_doubles(std::string("nor:normal") + "XYZ" [a], { slant[a], 5, slant[2 - a] }));
  const Read some = read(e57_file({scan, scan}));
  EXPECT_EQ(some.cloud.points,
            (std::vector<Vec3>{{1, 0.1, 4}, {0, -3, 5 + 7 * 0.01}, {1, 0.1, 4}, {0, -3, 5 + 7 * 0.01}}));
  EXPECT_EQ(some.cloud.colours, (std::vector<Bytes>{{10, 10, 10}, {30, 30, 30}, {10, 10, 10}, {30, 30, 30}}));
  EXPECT_EQ(some.cloud.normals, (std::vector<Vec3>{{1, 0, 0.6}, {0.6, 0, 1}, {1, 0, 0.6}, {0.6, 0, 1}}));
  EXPECT_THAT(some.cloud.scans, ElementsAre(0, 0, 1, 1));
  EXPECT_EQ(some.notes.at(0).message, "2 points are marked as invalid and left out");
  // Normals turn with the scan.
  scan.more = quarter_turn_and_step;
  EXPECT_LE((read(e57_file({scan})).cloud.normals[0] - Vec3(0, 1, 0.6)).norm(), 1e-15);
  // What not all scans have is for none.
  const PointCloud mixed = read(e57_file({scan, three_points()})).cloud;
  EXPECT_EQ(mixed.points.size(), 5u);
  EXPECT_THAT(mixed.normals, IsEmpty());
  EXPECT_THAT(mixed.colours, IsEmpty());
}

TEST(E57, ReadsColoursWithinTheirLimits) {
  const auto coloured = [](auto column, const std::string& more) {
    E57Scan scan = three_points();
    scan.more = more;
    for (const char* name : {"colorRed", "colorGreen", "colorBlue"}) scan.columns.push_back(column(name));
    return scan;
  };
  const auto bytes = [](const char* name) { return e57_integers(name, 0, 255, {0, 128, 255}); };
  const auto words = [](const char* name) { return e57_integers(name, 0, 65535, {0, 128 * 257, 65535}); };
  const auto reals = [](const char* name) { return e57_singles(name, {0, 0.5F, 1}); };
  const auto steps = [](const char* name) { return e57_integers(name, 0, 10, {0, 5, 10}, "scale=\"0.1\""); };
  const std::vector<Bytes> grey{{0, 0, 0}, {128, 128, 128}, {255, 255, 255}};
  for (const E57Scan& scan : {coloured(bytes, ""), coloured(bytes, limits("Integer", "0", "255")), coloured(words, ""),
                              coloured(reals, limits("Float", "0", "1")), coloured(steps, "")})
    EXPECT_EQ(read(e57_file({scan})).cloud.colours, grey);
  EXPECT_EQ(read(e57_file({coloured(bytes, limits("Integer", "0", "510"))})).cloud.colours[2], (Bytes{128, 128, 128}));
  EXPECT_THAT(refusal(e57_file({coloured(reals, "")})), HasSubstr("expected colorLimits"));
  EXPECT_THAT(refusal(e57_file({coloured(bytes, limits("Integer", "9", "0"))})), HasSubstr("not in order"));
  E57Scan narrow = coloured(bytes, limits("Integer", "0", "128"));
  EXPECT_THAT(refusal(e57_file({narrow})), HasSubstr("a colour of point 3 is out of its limits"));
  narrow.columns.push_back(e57_integers("isColorInvalid", 0, 1, {0, 0, 1}));
  const Read some = read(e57_file({narrow}));
  EXPECT_THAT(some.cloud.colours, IsEmpty());
  EXPECT_EQ(some.notes.at(0).message, "not every point has a colour, so none is kept");
  narrow.columns.push_back(e57_integers("cartesianInvalidState", 0, 2, {0, 0, 2}));
  EXPECT_EQ(read(e57_file({narrow})).cloud.colours.at(1), (Bytes{255, 255, 255}));
}

TEST(E57, RefusesWhatItsTextGetsWrong) {
  const std::vector<std::array<std::string, 3>> wrong{
      {"</data3D>", "</data4D>", "the XML is not well formed"},
      {"e57Root", "e58Root", "the XML is not well formed"},
      {"type=\"CompressedVector\"", "type=\"Vector\"", "no points of type CompressedVector"},
      {"recordCount=\"3\"", "recordCount=\"three\"", "'three' stands in 'points'; expected a number"},
      {"recordCount=\"3\"", "recordCount=\"-3\"", "'-3' stands in 'points'"},
      {"recordCount=\"3\"", "recordCount=\"30\"", "30 points are declared; the file has"},
      {"recordCount=\"3\"", "recordCount=\"4\"", "the section ends before the last of the scan's 4 points"},
      {"recordCount=\"3\"", "recordCount=\"1\"", "goes on after the scan's 1 points"},
      {"recordCount=\"3\"", "recordCount=\"18446744073709551615\"", "expected at most 100000000"},
      {"recordCount=\"3\"", "recordCount=\"18446744073709551616\"", "expected a number"},
      {"fileOffset=\"48\"", "fileOffset=\"1020\"", "leads to byte 1020, where the file has no content"},
      {"fileOffset=\"48\"", "fileOffset=\"9999999\"", "where the file has no content"},
      {"fileOffset=\"48\"", "fileOffset=\"52\"", "expected a section with points here"},
      {"<cartesianX type=\"Float\"", "<cartesianX type=\"Blob\"", "a column of type 'Blob'"},
      {"<cartesianX type", "<cartesianU type", "the columns are no coordinates"},
      {"<cartesianX type", "<cartesianY type", "column 'cartesianY' is there twice"},
      {"maximum=\"1000\"", "maximum=\"-101\"", "the maximum of a column is below its minimum"},
      {"maximum=\"1000\"", "maximum=\"1e3\"", "'1e3' stands in 'cartesianZ'"},
      {"maximum=\"1000\"", "maximum=\"999\"", "a value is above the maximum of its column"},
      {"scale=\"0.01\"", "scale=\"inf\"", "expected a number"},
      {"scale=\"0.01\"", "scale=\"\"", "expected a number"},
      {"></codecs>", "><vectorChild><zipCodec/></vectorChild></codecs>", "packed with 'zipCodec'"},
      {"0.7071067811865476<", "0.8<", "the rotation of a scan is no unit quaternion"},
      {">10<", ">far<", "'far' stands in 'x'; expected a number"},
      {">10<", ">nan<", "'nan' stands in 'x'"},
  };
  E57Scan scan = three_points();
  scan.more = quarter_turn_and_step;
  ASSERT_EQ(refusal(e57_file({scan})), "");
  for (const auto& [from, to, reason] : wrong)
    EXPECT_THAT(refusal(e57_file({scan}, from, to)), HasSubstr(reason)) << to;
  std::string many = "<prototype type=\"Structure\">";
  for (int n = 0; n < 1025; ++n) many += "<a type=\"Float\"/>";
  EXPECT_THAT(refusal(e57_file({scan}, "<prototype type=\"Structure\">", many)), HasSubstr("more than 1024 columns"));
  EXPECT_THAT(refusal(e57_file({scan}, "e57Root type", "root><e57Root type")), HasSubstr("not well formed"));
  // Where the text is wrong is told as a place of the file.
  const std::string file = e57_file({scan}, ">10<", ">far<");
  const std::string text = refusal(file);
  std::size_t place = 0;
  ASSERT_EQ(std::sscanf(text.c_str(), "a.e57: byte %zu:", &place), 1);
  EXPECT_EQ(file.substr(place, 8), "x type=\"");
}

TEST(E57, RefusesWhatItsPacketsGetWrong) {
  struct Wrong {
    std::size_t at;
    std::uint64_t value;
    std::size_t bytes;
    const char* reason;
  };
  constexpr std::size_t section = 48, packet = section + 32;
  const std::vector<Wrong> wrong{
      {0, 'B', 1, "begins with 'ASTM-E57'"},
      {8, 2, 4, "E57 version 2.0; expected 1.0"},
      {12, 1, 4, "E57 version 1.1; expected 1.0"},
      {24, 1021, 8, "leads to byte 1021"},
      {24, ~std::uint64_t{0}, 8, "byte 24: leads to byte 18446744073709551615"},
      {32, 100'000, 8, "the XML has 100000 bytes; the file ends before"},
      {32, ~std::uint64_t{0}, 8, "the file ends before"},
      {32, 0, 8, "the XML is not well formed"},
      {40, 512, 8, "not made of pages of 1024 bytes"},
      {section, 2, 1, "expected a section with points here"},
      {section + 8, 31, 8, "a section of 31 bytes; expected 32 to "},
      {section + 8, ~std::uint64_t{0}, 8, "a section of 18446744073709551615 bytes"},
      {section + 8, 40, 8, "3 points are declared; the file has 8 bytes"},
      {section + 16, 1022, 8, "leads to byte 1022"},
      {section + 16, 48, 8, "the points do not stand within their section"},
      {section + 16, 512, 8, "the points do not stand within their section"},
      {packet, 3, 1, "a packet of kind 3; expected 0, 1 or 2"},
      {packet, 2, 1, "the section ends before the last of the scan's 3 points"},
      {packet + 2, 60, 2, "a packet of 61 bytes; expected a multiple of 4"},
      {packet + 2, 65535, 2, "a packet of 65536 bytes"},
      {packet + 2, 3, 2, "a packet does not have the scan's 3 columns"},
      {packet + 4, 4, 2, "a packet does not have the scan's 3 columns"},
      {packet + 6, 65535, 2, "the columns of a packet are longer than it"},
      {packet + 6, 8, 2, "the section ends before the last"},
  };
  for (const Wrong& w : wrong) {
    std::string content = e57_content({three_points()});
    std::memcpy(content.data() + w.at, &w.value, w.bytes);
    EXPECT_THAT(refusal(e57_pages(content)), HasSubstr(w.reason)) << "byte " << w.at;
  }
}

TEST(E57, RefusesAFileWithAnyByteChangedOrLost) {
  E57Scan scan = three_points();
  scan.packet_bytes = 3;
  const std::string file = e57_file({scan, scan});
  ASSERT_GE(file.size(), 2048u);
  for (std::size_t at = 0; at < file.size(); ++at) {
    std::string changed = file;
    changed[at] = static_cast<char>(changed[at] ^ 4);
    ASSERT_NE(refusal(changed), "") << "byte " << at;
    ASSERT_NE(refusal(std::string_view(file).substr(0, at)), "") << "cut to " << at << " bytes";
  }
  EXPECT_NE(refusal(file + std::string(1024, '\0')), "");
  std::string second = file;
  second[1500] = 'x';
  EXPECT_THAT(refusal(second), HasSubstr("byte 1024: page 2 of 2 is damaged: its checksum does not fit"));
  // The checksum is that of the published example of CRC-32C.
  EXPECT_EQ(test::e57_checksum("123456789"), 0xE3069283u);
}

TEST(E57, TakesNoMemoryForPointsThatAreOnlyDeclared) {
  E57Scan still{{}, "", 512, false};
  for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
    still.columns.push_back(e57_integers(axis, 7, 7, {7, 7, 7}));
  EXPECT_EQ(read(e57_file({still})).cloud.points, std::vector<Vec3>(3, Vec3(7, 7, 7))) << "values that take no bits";
  EXPECT_THAT(refusal(e57_file({still}, "recordCount=\"3\"", "recordCount=\"99999999\"")), HasSubstr("are declared"));
  // Two scans may not point at the same section: a small file could tell of any number of them.
  std::vector<E57Scan> scans(40, three_points());
  std::string content = e57_content(scans);
  const std::size_t length = e57_content({three_points()}).find("<?xml") - 48;
  for (std::size_t n = 1; n < 40; ++n) {
    const std::string from = "fileOffset=\"" + std::to_string(test::e57_place(48 + n * length)) + "\"";
    std::string to = "fileOffset=\"48\"";
    to.resize(from.size(), ' ');
    const std::size_t at = content.find(from);
    ASSERT_NE(at, content.npos) << from;
    content.replace(at, from.size(), to);
  }
  const std::uint64_t all = content.size() - 48;
  std::memcpy(content.data() + 56, &all, 8);
  EXPECT_THAT(refusal(e57_pages(content)), HasSubstr("the sections of the scans overlap"));

  E57Scan many{{}, "", 60'000, false};
  for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
    many.columns.push_back(e57_integers(axis, 0, 1, std::vector<std::int64_t>(1'000'000, 1)));
  many.packet_bytes = 20'000;
  const std::string million = e57_file({many});
  EXPECT_EQ(read(million).cloud.points.size(), 1'000'000u);
  const MemoryLimit limit(std::uint64_t{100} << 20);
  EXPECT_THAT(refusal(million), HasSubstr("--memory-limit"));
}

TEST(E57, ReadsOrRefusesDamagedContent) {
  E57Scan scan = three_points();
  scan.more = quarter_turn_and_step + limits("Integer", "0", "255");
  scan.has_other_packets = true;
  for (const char* name : {"colorRed", "colorGreen", "colorBlue"})
    scan.columns.push_back(e57_integers(name, 0, 255, {10, 20, 30}));
  const std::string whole = e57_content({scan, three_points()});
  std::mt19937 random(7);
  std::size_t read_all_the_same = 0;
  for (int n = 0; n < 20'000; ++n)
    if (const std::string some = test::damaged(whole, random); some.size() >= 24)
      read_all_the_same += refusal(e57_pages(some)).empty();
  EXPECT_GT(read_all_the_same, 100u) << "or nothing behind the first check was tried";
}

}  // namespace
}  // namespace dynasurf::io
