#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"

#include "support/damage.hpp"
#include "support/laz_writer.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using test::laz;
using test::LazFile;
using test::LazPoint;
using test::ScratchFolder;
using test::write_bytes;
using ::testing::HasSubstr;

/// What an aircraft sees of hills and trees: pulses with one to four returns, strips, channels, noise, colours.
std::vector<LazPoint> flight(std::size_t count, std::uint32_t seed = 3) {
  std::mt19937 random(seed);
  std::vector<LazPoint> points;
  std::uint8_t returns = 1, number = 1;
  for (std::size_t n = 0; n < count; ++n) {
    LazPoint p = points.empty() ? LazPoint() : points.back();
    if (number >= returns) {
      returns = static_cast<std::uint8_t>(random() % 3 == 0 ? 1 + random() % 5 : 1);
      number = 1;
      p.has_new_time = random() % 4 != 0;
      p.channel = static_cast<std::uint8_t>(random() % 5 == 0 ? random() % 4 : p.channel);
    } else {
      ++number;
      p.has_new_time = false;
    }
    p.returns = returns;
    p.number = number;
    const double t = 0.001 * static_cast<double>(n);
    p.place = {static_cast<std::int32_t>(40'000 * std::sin(31 * t)) + static_cast<std::int32_t>(random() % 40),
               static_cast<std::int32_t>(9'000 * t) + static_cast<std::int32_t>(random() % 40),
               static_cast<std::int32_t>(3'000 * std::cos(7 * t)) + 900 * (returns - number) +
                   static_cast<std::int32_t>(random() % 9)};
    if (random() % 500 == 0) p.place[random() % 3] = static_cast<std::int32_t>(random());  // a bird, or a cloud
    p.intensity = static_cast<std::uint16_t>(random() % 300);
    if (random() % 20 == 0) p.kind = static_cast<std::uint8_t>(random() % 6);
    if (random() % 300 == 0) p.kind = 7;
    p.flags =
        static_cast<std::uint8_t>((random() % 200 == 0 ? 4u : 0u) | (random() % 50 == 0 ? 48u : n / 700 % 2 << 4));
    if (random() % 90 == 0) p.user = static_cast<std::uint8_t>(random());
    if (n % 900 == 899) p.source = static_cast<std::uint16_t>(random() % 5 * 1000);
    for (std::size_t c = 0; c < 3; ++c)
      p.colour[c] = static_cast<std::uint16_t>(p.colour[c] + (random() % 4 == 0 ? random() % 2000 : random() % 3));
    if (random() % 9 == 0) p.colour[1] = p.colour[2] = p.colour[0];
    points.push_back(p);
  }
  return points;
}

/// What a reader should make of them.
PointCloud expected(const std::vector<LazPoint>& points, int format) {
  PointCloud cloud;
  std::vector<std::uint32_t> sources;
  for (const LazPoint& p : points) {
    const bool withheld = (p.flags & 4) != 0;
    if (withheld || p.kind == 7) continue;
    Vec3 place;
    for (Eigen::Index axis = 0; axis < 3; ++axis) place[axis] = p.place[static_cast<std::size_t>(axis)] * 0.001;
    cloud.points.push_back(place);
    const bool has_colour = format == 2 || format == 3 || format >= 7;
    if (has_colour) {
      auto& colour = cloud.colours.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) colour[c] = detail::colour_byte(p.colour[c], 65535);
    }
    auto found = std::find(sources.begin(), sources.end(), p.source);
    if (found == sources.end()) found = sources.insert(found, p.source);
    cloud.scans.push_back(static_cast<std::uint32_t>(found - sources.begin()));
  }
  if (sources.size() == 1) cloud.scans.clear();
  return cloud;
}

class ReadLaz : public testing::Test {
 protected:
  PointCloud read(const std::string& bytes) {
    write_bytes(folder / "a.laz", bytes);
    return read_cloud(std::vector{folder / "a.laz"}).cloud;
  }
  /// The message with which a file of this content is refused; empty when it is not.
  static std::string refusal(std::string_view bytes) {
    CloudSource source;
    Notes notes;
    try {
      detail::decode_cloud({"a.laz", bytes}, source, notes);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  ScratchFolder folder;
};

void expect_same(const PointCloud& a, const PointCloud& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.colours, b.colours);
  EXPECT_EQ(a.scans, b.scans);
}

TEST_F(ReadLaz, HoldsThePointsThatWereWrittenInEachFormat) {
  const std::vector<LazPoint> points = flight(30'000);
  for (const int format : {0, 1, 2, 3, 6, 7, 8}) {
    SCOPED_TRACE(format);
    expect_same(read(laz(points, {.format = format, .chunk = 7000})), expected(points, format));
  }
}

TEST_F(ReadLaz, SkipsBytesBehindPointsAndLayersThatAreNotAskedFor) {
  const std::vector<LazPoint> points = flight(5'000, 4);
  for (const int format : {0, 3, 6, 7}) {
    SCOPED_TRACE(format);
    const LazFile file{.format = format, .chunk = 2000, .extra_bytes = 5};
    expect_same(read(laz(points, file, true)), expected(points, format));
  }
}

TEST_F(ReadLaz, FindsChunksInEveryWayTheyAreTold) {
  const std::vector<LazPoint> points = flight(6'000, 5);
  for (const LazFile& file :
       {LazFile{.format = 1, .chunk = 6000}, LazFile{.format = 1, .chunk = 5999},
        LazFile{.format = 2, .is_one_chunk = true}, LazFile{.format = 2, .chunk = 500, .has_late_table = true},
        LazFile{.format = 7, .chunk = 800, .tells_counts = true}, LazFile{.format = 0, .chunk = 1},
        LazFile{.format = 7, .chunk = 1}})
    expect_same(read(laz(points, file)), expected(points, file.format));
}

TEST_F(ReadLaz, TakesLayersInWhichNothingChanges) {
  std::vector<LazPoint> points(20'000);  // so many that what always comes is counted anew
  for (std::size_t n = 0; n < points.size(); ++n) {
    points[n].place = {static_cast<std::int32_t>(n), 5, 77};
    points[n].colour = {1000, 2000, 65535};
    points[n].source = 9;
  }
  for (const int format : {3, 7}) expect_same(read(laz(points, {.format = format})), expected(points, format));
}

TEST_F(ReadLaz, HoldsTheSamePointsOnOneThread) {
  const std::string bytes = laz(flight(9'000, 6), {.format = 7, .chunk = 400});
  const PointCloud all = read(bytes);
  const ThreadLimit one(1);
  expect_same(read(bytes), all);
}

TEST_F(ReadLaz, HoldsTheWholeRangeOfCoordinates) {
  constexpr std::int32_t least = std::numeric_limits<std::int32_t>::min(), most = -(least + 1);
  std::vector<LazPoint> points(200);
  std::mt19937 random(8);
  for (LazPoint& p : points)
    for (auto& c : p.place) c = random() % 2 == 0 ? least : random() % 2 == 0 ? most : 0;
  for (const int format : {0, 6}) expect_same(read(laz(points, {.format = format})), expected(points, format));
}

TEST_F(ReadLaz, RefusesFilesThatLie) {
  const std::vector<LazPoint> points = flight(3'000, 7);
  const auto changed = [&](std::size_t place, auto value, int format = 2) {
    std::string bytes = laz(points, {.format = format, .chunk = 1000});
    std::memcpy(bytes.data() + place, &value, sizeof value);
    return bytes;
  };
  constexpr std::size_t coding = 227 + 54;
  EXPECT_THAT(refusal(changed(100, std::uint32_t{0})), HasSubstr("no header of LASzip"));
  EXPECT_THAT(refusal(changed(229, 'x')), HasSubstr("no header of LASzip"));
  EXPECT_THAT(refusal(changed(coding - 34, std::uint16_t{60000})), HasSubstr("no header of LASzip"));
  EXPECT_THAT(refusal(changed(coding - 34, std::uint16_t{20})), HasSubstr("header of LASzip is cut"));
  EXPECT_THAT(refusal(changed(coding, std::uint16_t{9})), HasSubstr("a coder of LAZ that is not known"));
  EXPECT_THAT(refusal(changed(coding, std::uint16_t{3})), HasSubstr("a coder of LAZ that is not known"));
  EXPECT_THAT(refusal(changed(coding + 2, std::uint16_t{1})), HasSubstr("a coder of LAZ that is not known"));
  EXPECT_THAT(refusal(changed(coding + 12, std::uint32_t{0})), HasSubstr("chunks of no points"));
  EXPECT_THAT(refusal(changed(coding + 38, std::uint16_t{1})),
              HasSubstr("version of LAZ that is not read; expected LAZ as 'laszip"));
  EXPECT_THAT(refusal(changed(coding + 36, std::uint16_t{21})), HasSubstr("version of LAZ that is not read"));
  const std::size_t begin = coding + 34 + 12;
  EXPECT_THAT(refusal(changed(begin, std::uint64_t{1} << 60)), HasSubstr("table of chunks is missing"));
  EXPECT_THAT(refusal(changed(begin, ~std::uint64_t{0})), HasSubstr("table of chunks is missing"));
  EXPECT_THAT(refusal(changed(107, std::uint32_t{3001})), HasSubstr("3001 points are declared; the chunks hold 3000"));
  EXPECT_THAT(refusal(changed(107, std::uint32_t{4'000'000'000})), HasSubstr("points"));
  EXPECT_THAT(refusal(changed(375 + 54 + 34 + 12 + 8 + 36, std::uint32_t{999}, 7)), HasSubstr("damaged"));
  EXPECT_THAT(refusal(changed(375 + 54 + 34 + 12 + 8 + 36 + 4, std::uint32_t{1u << 31}, 7)), HasSubstr("damaged"));
  const std::string whole = laz(points, {.format = 2, .chunk = 1000});
  std::uint64_t table = 0;
  std::memcpy(&table, whole.data() + begin, 8);
  EXPECT_THAT(refusal(changed(table + 4, ~std::uint32_t{0})), HasSubstr("4294967295 chunks do not fit"));
  EXPECT_THAT(refusal(changed(table + 4, std::uint32_t{2})), HasSubstr("the chunks hold 2000"));
  EXPECT_THAT(refusal(changed(table + 8, ~std::uint64_t{0})), HasSubstr("table of chunks does not fit"));
}

TEST_F(ReadLaz, RefusesPointsThatCannotStandInTheirBytes) {
  std::string bytes = laz(flight(10, 7), {.format = 0, .is_one_chunk = true});
  const std::uint32_t points = 50'000'000;
  std::memcpy(bytes.data() + 107, &points, sizeof points);
  EXPECT_THAT(refusal(bytes), HasSubstr("50000000 points cannot stand in"));
}

TEST_F(ReadLaz, RefusesFilesThatWereCut) {
  for (const int format : {1, 7}) {
    const std::string whole = laz(flight(2'000, 9), {.format = format, .chunk = 600});
    for (std::size_t size = 0; size < whole.size(); size += size < 700 ? 1 : 97)
      ASSERT_NE(refusal(std::string_view(whole).substr(0, size)), "") << size << " bytes of format " << format;
  }
}

TEST_F(ReadLaz, EndsWithPointsOrARefusalWhateverIsDamaged) {
  std::mt19937 random(10);
  std::size_t refused = 0;
  for (const int format : {1, 3, 7}) {
    const std::string whole = laz(flight(1'000, 11), {.format = format, .chunk = 300});
    for (int n = 0; n < 300; ++n) {
      std::string bytes = whole;
      for (std::uint32_t k = 1 + random() % 4; k > 0; --k) bytes[random() % bytes.size()] = static_cast<char>(random());
      refused += refusal(bytes).empty() ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 50u);
}

// Not a check by itself: leaves files for another reader of LAZ (tests/oracles/laz_reads.mjs).
TEST(Laz, WritesSamplesForAnotherReader) {
  const char* folder = std::getenv("DYNASURF_LAZ_SAMPLES");
  if (folder == nullptr) GTEST_SKIP() << "runs as part of io/laz_reads";
  for (const int format : {0, 1, 2, 3, 6, 7, 8}) {
    const std::vector<LazPoint> points = flight(20'000, 12 + static_cast<std::uint32_t>(format));
    const std::string name = std::string(folder) + "/format" + std::to_string(format);
    write_bytes(name + ".laz", laz(points, {.format = format, .chunk = 6000}));
    std::string plain;  // 12 numbers of 4 bytes a point
    for (const LazPoint& p : points) {
      for (const auto c : p.place) detail::append(plain, c);
      for (const std::uint32_t n : {std::uint32_t{p.number}, std::uint32_t{p.returns}, std::uint32_t{p.kind},
                                    std::uint32_t{p.flags} & 4, std::uint32_t{p.source}})
        detail::append(plain, n);
      for (const auto c : p.colour) detail::append(plain, std::uint32_t{c});
    }
    write_bytes(name + ".points", plain);
  }
}

}  // namespace
}  // namespace dynasurf::io
