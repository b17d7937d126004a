#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/mesh_io.hpp"

#include "support/damage.hpp"
#include "support/e57_writer.hpp"
#include "support/sample_meshes.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using detail::append;
using test::ScratchFolder;
using test::write_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Colours = std::vector<std::array<std::uint8_t, 3>>;

const std::vector<Vec3> four_points{{0, 0, 0}, {2, 0.5, 0}, {-2, 2, 1e-3}, {0, 2, 4}};
const std::vector<Vec3> four_normals{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}, {0.6, 0, 0.8}};
const Colours four_colours{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {10, 20, 30}};

std::string ply_binary(bool big_endian) {
  std::string out = "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
                    "_endian 1.0\nelement vertex 4\nproperty uchar blue\nproperty double x\nproperty double y\n"
                    "property double z\nproperty float confidence\nproperty double nx\nproperty double ny\n"
                    "property double nz\nproperty ushort red\nproperty float green\nend_header\n";
  const auto put = [&](auto number) {
    std::string bytes;
    append(bytes, number);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  };
  for (std::size_t n = 0; n < 4; ++n) {
    put(four_colours[n][2]);
    for (const double c : four_points[n]) put(c);
    put(0.5f);
    for (const double c : four_normals[n]) put(c);
    put(static_cast<std::uint16_t>(257 * four_colours[n][0]));
    put(static_cast<float>(four_colours[n][1]) / 255);
  }
  return out;
}

/// LAS 1.2 with points of format 2, or 1.4 with points of format 7.
std::string las(bool extended) {
  std::string out = "LASF";
  const std::size_t header = extended ? 375 : 227, record = extended ? 36 : 26;
  out.resize(header, '\0');
  const auto set = [&](std::size_t place, auto value) { std::memcpy(out.data() + place, &value, sizeof value); };
  set(24, std::uint8_t{1});
  set(25, static_cast<std::uint8_t>(extended ? 4 : 2));
  set(94, static_cast<std::uint16_t>(header));
  set(96, static_cast<std::uint32_t>(header + 10));  // as if a record of another kind stood between
  set(104, static_cast<std::uint8_t>(extended ? 7 : 2));
  set(105, static_cast<std::uint16_t>(record));
  set(107, std::uint32_t{extended ? 0u : 4u});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    set(131 + 8 * axis, 0.001);
    set(155 + 8 * axis, axis == 0 ? 500000.0 : 0.0);
  }
  if (extended) set(247, std::uint64_t{4});
  out.resize(header + 10, 'v');
  for (std::size_t n = 0; n < 4; ++n) {
    const std::size_t begin = out.size();
    out.resize(begin + record, '\0');
    for (std::size_t axis = 0; axis < 3; ++axis)
      set(begin + 4 * axis,
          static_cast<std::int32_t>(std::lround(four_points[n][static_cast<Eigen::Index>(axis)] * 1000)));
    set(begin + (extended ? 20 : 18), static_cast<std::uint16_t>(n < 2 ? 7 : 3));
    for (std::size_t c = 0; c < 3; ++c)
      set(begin + (extended ? 30 : 20) + 2 * c,
          static_cast<std::uint16_t>(extended ? 257 * four_colours[n][c] : four_colours[n][c]));
  }
  return out;
}

/// A PCD file of records, or of columns in LZF, here all literals but for one copy.
std::string pcd(bool compressed) {
  std::string out =
      "FIELDS x rgb y z normal_x normal_y normal_z\nSIZE 8 4 8 8 4 4 4\nTYPE F F F F F F F\nCOUNT 1 1 1 1 1 1 1\n"
      "WIDTH 2\nHEIGHT 2\nPOINTS 4\nDATA " +
      std::string(compressed ? "binary_compressed\n" : "binary\n");
  const auto field = [](std::size_t f, std::size_t n) {
    std::string bytes;
    const auto& c = four_colours[n];
    if (f == 1)
      append(bytes, static_cast<std::uint32_t>(c[0] << 16 | c[1] << 8 | c[2]));
    else if (f < 4)
      append(bytes, four_points[n][f == 0 ? 0 : static_cast<Eigen::Index>(f) - 1]);
    else
      append(bytes, static_cast<float>(four_normals[n][static_cast<Eigen::Index>(f) - 4]));
    return bytes;
  };
  std::string values;
  for (std::size_t a = 0; a < (compressed ? 7u : 4u); ++a)
    for (std::size_t b = 0; b < (compressed ? 4u : 7u); ++b) values += compressed ? field(a, b) : field(b, a);
  if (!compressed) return out + values;
  // The first eight bytes are 0: one as a literal, seven copied from one before.
  std::string packed{'\0', '\0', static_cast<char>(5 << 5), '\0'};
  for (std::size_t at = 8; at < values.size(); at += 32) {
    const std::string run = values.substr(at, 32);
    packed += static_cast<char>(run.size() - 1) + run;
  }
  append(out, static_cast<std::uint32_t>(packed.size()));
  append(out, static_cast<std::uint32_t>(values.size()));
  return out + packed;
}

std::string e57() {
  test::E57Scan scan;
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> places, normals;
    std::vector<std::int64_t> colours;
    for (std::size_t n = 0; n < 4; ++n) {
      places.push_back(four_points[n][static_cast<Eigen::Index>(a)]);
      normals.push_back(four_normals[n][static_cast<Eigen::Index>(a)]);
      colours.push_back(four_colours[n][a]);
    }
    scan.columns.push_back(test::e57_doubles(std::string("cartesian") + "XYZ"[a], places));
    scan.columns.push_back(test::e57_doubles(std::string("nor:normal") + "XYZ"[a], normals));
    const char* names[] = {"colorRed", "colorGreen", "colorBlue"};
    scan.columns.push_back(test::e57_integers(names[a], 0, 255, colours));
  }
  return test::e57_file({scan});
}

struct Dialect {
  const char* name;
  const char* file;
  std::string bytes;
  bool normals, colours;
  bool has_counts;  // a shorter file cannot pass for a whole one

  bool is_rows() const {
    const std::string_view ending = std::string_view(file).substr(1);
    return ending == ".xyz" || ending == ".txt" || ending == ".asc" || ending == ".pts" || ending == ".pwn" ||
           ending == ".csv";
  }
};

std::vector<Dialect> dialects() {
  const std::string names = "\"X\";\"Y\";\"Z\";class;NX;NY;NZ;Red;Green;Blue\n";
  return {
      {"ascii PLY", "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\n"
       "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n"
       "property uchar blue\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0 0 0 1 255 0 0\n2 0.5 0 0 1 0 0 255 0\n-2 2 1e-3 -1 0 0 0 0 255\n0 2 4 0.6 0 0.8 10 20 30\n",
       true, true, true},
      {"little-endian PLY", "a.ply", ply_binary(false), true, true, true},
      {"big-endian PLY", "a.PLY", ply_binary(true), true, true, true},
      {"XYZ", "a.xyz", "# seen\n0 0 0\n\n2\t+0.5 0\n-2 2 1e-3 \n  0 2 4\n", false, false, false},
      {"XYZ with normals", "a.xyz", "0 0 0 0 0 1\n2 0.5 0 0 1 0\n-2 2 1e-3 -1 0 0\n0 2 4 0.6 0 0.8\n", true, false,
       false},
      {"XYZ with colours", "a.txt", "// seen\n0 0 0 255 0 0\n2 0.5 0 0 255 0\n-2 2 1e-3 0 0 255\n0 2 4 10 20 30\n",
       false, true, false},
      {"XYZ with all", "a.asc",
       "0 0 0 255 0 0 0 0 1\n2 0.5 0 0 255 0 0 1 0\n-2 2 1e-3 0 0 255 -1 0 0\n0 2 4 10 20 30 0.6 0 0.8\n", true, true,
       false},
      {"PTS", "a.pts", "4\n0 0 0 -17 255 0 0\n2 0.5 0 5 0 255 0\n-2 2 1e-3 5.5 0 0 255\n0 2 4 5 10 20 30\n", false,
       true, true},
      {"PWN", "a.pwn", "0 0 0 0 0 1\n2 0.5 0 0 1 0\n-2 2 1e-3 -1 0 0\n0 2 4 0.6 0 0.8\n", true, false, false},
      {"CSV", "a.csv", "0,0,0\n2,0.5,0\n-2, 2,1e-3\n0,2,4\n", false, false, false},
      {"CSV with names", "a.csv",
       names + "0;0;0;wall;0;0;1;255;0;0\n2;0.5;0;;0;1;0;0;255;0\n-2;2;1e-3;x y;-1;0;0;0;0;255\n"
               "0;2;4;;0.6;0;0.8;10;20;30\n",
       true, true, false},
      {"OBJ", "a.obj",
       "v 0 0 0 1 0 0\nvn 0 0 1\nv 2 0.5 0 0 1 0\nv -2 2 1e-3 1.0 0 0 1\nv 0 2 4 0.0392157 0.0784314 0.117647\n"
       "vn 0 1 0\nvn -1 0 0\nvn 0.6 0 0.8\np 1\n",
       true, true, false},
      {"OFF", "a.off",
       "CNOFF\n4 0 0\n0 0 0 0 0 1 255 0 0\n2 0.5 0 0 1 0 0 1.0 0\n-2 2 1e-3 -1 0 0 0 0 255 9\n"
       "0 2 4 0.6 0 0.8 10 20 30\n",
       true, true, true},
      {"ascii PCD", "a.pcd",
       "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z normal_x normal_y normal_z rgb\nSIZE 8 8 8 4 4 4 4\n"
       "TYPE F F F F F F U\nCOUNT 1 1 1 1 1 1 1\nWIDTH 4\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ascii\n"
       "0 0 0 0 0 1 16711680\n2 0.5 0 0 1 0 65280\n-2 2 1e-3 -1 0 0 255\n0 2 4 0.6 0 0.8 660510\n",
       true, true, true},
      {"binary PCD", "a.pcd", pcd(false), true, true, true},
      {"compressed PCD", "a.pcd", pcd(true), true, true, true},
      {"LAS 1.2", "a.las", las(false), false, true, true},
      {"LAS 1.4", "a.las", las(true), false, true, true},
      {"E57", "a.e57", e57(), true, true, true},
  };
}

class ReadCloud : public testing::Test {
 protected:
  CloudInput read(const std::string& name, const std::string& bytes) {
    write_bytes(folder / name, bytes);
    return read_cloud(std::vector{folder / name});
  }
  /// The message with which a file of this name and content is refused; empty when it is not.
  static std::string refusal(const std::string& name, std::string_view bytes) {
    try {
      decode(name, bytes);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static PointCloud decode(const std::string& name, std::string_view bytes) {
    CloudSource source;
    Notes notes;
    return detail::decode_cloud({name, bytes}, source, notes);
  }
  static bool tells_of_no_end(const std::string& name, std::string_view bytes) {
    CloudSource source;
    Notes notes;
    detail::decode_cloud({name, bytes}, source, notes);
    return std::any_of(notes.begin(), notes.end(), [](const Note& n) { return n.code == "read.no_end"; });
  }
  static std::vector<std::string> codes(const CloudInput& input) {
    std::vector<std::string> codes;
    for (const Note& note : input.notes) codes.push_back(note.code);
    return codes;
  }
  ScratchFolder folder;
};

TEST_F(ReadCloud, ReadsTheSamePointsFromEveryDialect) {
  for (const Dialect& d : dialects()) {
    const CloudInput input = read(d.file, d.bytes);
    const bool shifted = d.name[0] == 'L';  // LAS: large coordinates, steps of a thousandth
    ASSERT_EQ(input.cloud.points.size(), 4u) << d.name;
    for (std::size_t n = 0; n < 4; ++n) {
      const Vec3 expected = four_points[n] + (shifted ? Vec3(500000, 0, 0) : Vec3(0, 0, 0));
      EXPECT_LE((input.cloud.points[n] - expected).norm(), shifted ? 1e-9 : 0) << d.name;
    }
    ASSERT_EQ(input.cloud.normals.size(), d.normals ? 4u : 0u) << d.name;
    for (std::size_t n = 0; n < input.cloud.normals.size(); ++n)
      EXPECT_LE((input.cloud.normals[n] - four_normals[n]).norm(), 1e-7) << d.name;
    EXPECT_EQ(input.cloud.colours, d.colours ? four_colours : Colours{}) << d.name;
    EXPECT_EQ(input.sources.at(0).points, 4u);
    EXPECT_EQ(input.sources.at(0).triangles, 0u);
  }
}

TEST_F(ReadCloud, ReadsLinesThatEndTheWayOfWindows) {
  for (const Dialect& d : dialects()) {
    if (d.bytes.find('\0') != std::string::npos) continue;
    std::string windows;
    for (const char c : d.bytes) windows += c == '\n' ? "\r\n" : std::string(1, c);
    EXPECT_EQ(read(d.file, windows).cloud.points, read(d.file, d.bytes).cloud.points) << d.name;
  }
}

TEST_F(ReadCloud, RefusesAFileCutAnywhere) {
  for (const Dialect& d : dialects()) {
    ASSERT_EQ(refusal(d.file, d.bytes), "") << d.name;
    for (std::size_t size = 0; size < d.bytes.size(); ++size) {
      // Rows without a count that are cut at the end of a row are a smaller cloud, and nobody can tell.
      if (!d.has_counts && size > 0 && d.bytes[size - 1] == '\n') continue;
      const std::string_view cut = std::string_view(d.bytes).substr(0, size);
      const std::string reason = refusal(d.file, cut);
      // Many programs end rows with no line break after the last one: a row with all its columns is taken, and told.
      if (reason.empty() && d.is_rows()) {
        EXPECT_TRUE(tells_of_no_end(d.file, cut)) << d.name << " cut to " << size << " bytes";
        continue;
      }
      EXPECT_THAT(reason, HasSubstr(d.file)) << d.name << " cut to " << size << " bytes";
      EXPECT_EQ(reason.find('\n'), std::string::npos);
    }
  }
}

TEST_F(ReadCloud, SurvivesThousandsOfDamagedFiles) {
  std::mt19937 random(20260103);
  std::size_t read_whole = 0, refused = 0;
  for (const Dialect& d : dialects())
    for (int i = 0; i < 400; ++i) {
      const std::string bytes = test::damaged(d.bytes, random);
      try {
        const PointCloud cloud = decode(d.file, bytes);
        ++read_whole;
        ASSERT_FALSE(cloud.points.empty());
        for (const std::size_t size : {cloud.normals.size(), cloud.colours.size(), cloud.scans.size()})
          ASSERT_TRUE(size == 0 || size == cloud.points.size()) << d.name;
      } catch (const InputError& error) {
        ++refused;
        ASSERT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos) << error.what();
      }
    }
  // Both happen, or the damage would test nothing.
  EXPECT_GT(read_whole, 500u);
  EXPECT_GT(refused, 500u);
}

TEST_F(ReadCloud, TellsNormalsFromColoursByTheirValues) {
  EXPECT_EQ(read("a.xyz", "1 2 3 0 0 1\n4 5 6 1 0 0\n").cloud.normals.size(), 2u) << "whole numbers of length 1";
  EXPECT_EQ(read("a.xyz", "1 2 3 0 0 1\n4 5 6 1 0 7\n").cloud.colours.size(), 2u);
  EXPECT_THAT(refusal("a.xyz", "1 2 3 0.5 0 7\n"), HasSubstr("neither unit normals nor colours"));
  EXPECT_EQ(read("a.pwn", "1 2 3 0.5 0 7\n").cloud.normals.size(), 1u) << "PWN has normals of any length";
  EXPECT_THAT(refusal("a.xyz", "1 2\n"), HasSubstr("line 1: 2 columns without names"));
  EXPECT_THAT(refusal("a.xyz", "1 2 3\n4 5 6 7\n"), HasSubstr("line 2: a row of 4 columns; expected 3"));
  EXPECT_THAT(refusal("a.xyz", "1 2 3\n4 5 six\n"), HasSubstr("line 2: 'six' stands for a value"));
  EXPECT_THAT(refusal("a.csv", "x,y,height\n1,2,3\n"), HasSubstr("names no columns x, y and z"));
  EXPECT_THAT(refusal("a.csv", "x,y,z,x\n1,2,3,4\n"), HasSubstr("twice"));
}

TEST_F(ReadCloud, ReadsTablesAsSpreadsheetsWriteThem) {
  const CloudInput input =
      read("a.csv", "\xEF\xBB\xBFX;Y;Z;Red;Green;Blue\r\n1,5;-2,25;3;0,5;0;1\r\n4;5,125;6;1;1;0,25");
  EXPECT_EQ(input.cloud.points, (std::vector<Vec3>{{1.5, -2.25, 3}, {4, 5.125, 6}}));
  EXPECT_EQ(input.cloud.colours, (Colours{{128, 0, 255}, {255, 255, 64}}));
  EXPECT_THAT(codes(input), ElementsAre("read.no_end", "read.no_count"));
  EXPECT_EQ(read("a.csv", "1,5;2,5;3,5\n").cloud.points, (std::vector<Vec3>{{1.5, 2.5, 3.5}}));
  EXPECT_THAT(refusal("a.csv", "1,5,0;2;3\n"), HasSubstr("'1,5,0' stands for a value"));
  EXPECT_THAT(refusal("a.csv", "1.5;2,5;3,5,\n"), HasSubstr("'3,5,' stands for a value"));
}

TEST_F(ReadCloud, ReadsTablesAsParaViewWritesThem) {
  const CloudInput input = read("a.csv",
                                "\"Intensity\",\"Normals:0\",\"Normals:1\",\"Normals:2\",\"RGB:0\",\"RGB:1\","
                                "\"RGB:2\",\"Points:0\",\"Points:1\",\"Points:2\"\n"
                                "7,0,0,1,255,0,9,1.5,2,3\n8,0,1,0,1,2,3,4,5,6");
  EXPECT_EQ(input.cloud.points, (std::vector<Vec3>{{1.5, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(input.cloud.normals, (std::vector<Vec3>{{0, 0, 1}, {0, 1, 0}}));
  EXPECT_EQ(input.cloud.colours, (Colours{{255, 0, 9}, {1, 2, 3}}));
  EXPECT_THAT(codes(input), ElementsAre("read.no_end", "read.no_count"));
  EXPECT_EQ(read("a.csv", "Points_0;Points_1;Points_2\n1,5;2;3\n").cloud.points, (std::vector<Vec3>{{1.5, 2, 3}}));
  EXPECT_THAT(refusal("a.csv", "x,y,z,Points:0\n1,2,3,4\n"), HasSubstr("twice"));
}

TEST_F(ReadCloud, ReadsColoursFromZeroToOne) {
  const CloudInput input = read("a.xyz", "0 0 0 0.5 0.5 0.5\n1 0 0 1 0 0.25\n0 1 0 0 0 0\n");
  EXPECT_EQ(input.cloud.colours, (Colours{{128, 128, 128}, {255, 0, 64}, {0, 0, 0}}));
}

TEST_F(ReadCloud, BringsTheScansOfAPtxFileToOneFrame) {
  const std::string still = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", unit = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  // A quarter turn about z, then a step along x.
  const std::string turned = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 0 0 1\n";
  const std::string file = "2\n1\n" + still + unit + "1 2 3 0.5 255 0 0\n0 0 0 0.5 0 0 0\n" + "1\n2\n" + still +
                           turned + "1 0 0 0.5 0 255 0\n0 2 0 0.1 10 20 30\n";
  const CloudInput input = read("a.ptx", file);
  EXPECT_EQ(input.cloud.points, (std::vector<Vec3>{{1, 2, 3}, {10, 1, 0}, {8, 0, 0}}));
  EXPECT_EQ(input.cloud.colours, (Colours{{255, 0, 0}, {0, 255, 0}, {10, 20, 30}}));
  EXPECT_EQ(input.cloud.scans, (std::vector<std::uint32_t>{0, 1, 1}));
  EXPECT_THAT(codes(input), ElementsAre("read.left_out", "read.scans"));
  EXPECT_THAT(refusal("a.ptx", file + "3\n1\n"), HasSubstr("the file ends before"));
}

TEST_F(ReadCloud, TellsWhereTheScansWereTakenFrom) {
  const std::string axes = "1 0 0\n0 1 0\n0 0 1\n", still = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  const std::string moved = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 0 3 1\n", point = "1 2 3 0.5\n";
  const std::string ptx = "1\n1\n0 0 0\n" + axes + moved + "0 0 0 0.5\n" + "1\n1\n4 5 6\n" + axes + still + point +
                          "1\n1\n0 0 0\n" + axes + moved + point;
  // The first scan saw nothing: the others take its number.
  const CloudInput seen = read("a.ptx", ptx);
  EXPECT_THAT(seen.cloud.scans, ElementsAre(0, 1));
  EXPECT_THAT(seen.cloud.scanners, ElementsAre(Vec3(4, 5, 6), Vec3(10, 0, 3)));

  const std::string head = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nVIEWPOINT ";
  EXPECT_THAT(read("a.pcd", head + "7 8 9 1 0 0 0\nDATA ascii\n1 2 3\n").cloud.scanners, ElementsAre(Vec3(7, 8, 9)));
  EXPECT_THAT(read("b.pcd", head + "0 0 0 1 0 0 0\nDATA ascii\n1 2 3\n").cloud.scanners, IsEmpty());
  EXPECT_THAT(refusal("c.pcd", head + "0 0 nan 1 0 0 0\nDATA ascii\n1 2 3\n"), HasSubstr("the viewpoint is nan"));
  EXPECT_THAT(refusal("c.pcd", head + "0 0 1\nDATA ascii\n1 2 3\n"), HasSubstr("ends before the viewpoint"));

  // Of a file that does not tell it is not known.
  write_bytes(folder / "c.xyz", "0 0 0\n");
  const CloudInput mixed = read_cloud(std::vector{folder / "c.xyz", folder / "a.ptx", folder / "a.pcd"});
  EXPECT_THAT(mixed.cloud.scans, ElementsAre(0, 1, 2, 3));
  ASSERT_EQ(mixed.cloud.scanners.size(), 4u);
  EXPECT_FALSE(mixed.cloud.scanners[0].allFinite());
  EXPECT_EQ(mixed.cloud.scanners[2], Vec3(10, 0, 3));
  EXPECT_EQ(mixed.cloud.scanners[3], Vec3(7, 8, 9));
  EXPECT_THAT(read_cloud(std::vector{folder / "c.xyz", folder / "b.pcd"}).cloud.scanners, IsEmpty());
}

TEST_F(ReadCloud, RefusesPcdFilesThatLie) {
  const std::string head = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ";
  EXPECT_EQ(decode("a.pcd", head + "ascii\n0 0 1\n1 2 3\n").points, (std::vector<Vec3>{{0, 0, 1}, {1, 2, 3}}));
  EXPECT_THAT(refusal("a.pcd", head + "ascii\n0 0 1\n"), HasSubstr("2 points are declared"));
  EXPECT_THAT(refusal("a.pcd", head + "ascii\n0 0 10\n1 2000\n"), HasSubstr("a row of 2 values; expected 3"));
  EXPECT_THAT(refusal("a.pcd", head + "binary\n0123"), HasSubstr("2 points are declared; the file has 4 bytes"));
  EXPECT_THAT(refusal("a.pcd", head + "packed\n0 0 1\n1 2 3\n....................."), HasSubstr("DATA is 'packed'"));
  std::string compressed = head + "binary_compressed\n";
  append(compressed, std::uint32_t{3});
  append(compressed, std::uint32_t{24});
  EXPECT_THAT(refusal("a.pcd", compressed + "\xE0\xFF\xFF"), HasSubstr("the compressed points are broken"));
  EXPECT_THAT(refusal("a.pcd", "FIELDS a b c\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 0\nDATA ascii\n"),
              HasSubstr("names no x, y and z"));
}

TEST_F(ReadCloud, KeepsPlacesWhereTheScannerSawNothing) {
  const CloudInput input = read("a.xyz", "0 0 0\nnan nan nan\ninf 0 0\n1 1 1\n");
  ASSERT_EQ(input.cloud.points.size(), 4u);
  EXPECT_TRUE(std::isnan(input.cloud.points[1][0]));
  EXPECT_EQ(read("a.csv", "0,0,0\n,,\n1,1,1\n").cloud.points.size(), 3u) << "an empty cell was not measured";
  std::string ply = ply_binary(false);
  const double nothing = std::nan("");
  std::memcpy(ply.data() + ply.find("end_header\n") + 11 + 1, &nothing, 8);
  EXPECT_EQ(read("a.ply", ply).cloud.normals.size(), 4u) << "the normals of finite points are whole";
}

TEST_F(ReadCloud, DropsNormalsThatAreNotWholeAndSaysSo) {
  for (const char* bad : {"0 0 0", "nan 0 0", "inf 0 0"}) {
    const CloudInput input = read("a.pwn", "0 0 0 0 0 1\n1 0 0 " + std::string(bad) + "\n");
    EXPECT_TRUE(input.cloud.normals.empty()) << bad;
    EXPECT_THAT(codes(input), ElementsAre("read.no_count", "read.normals_dropped"));
  }
}

TEST_F(ReadCloud, NumbersTheScansOfOneAndOfSeveralFiles) {
  EXPECT_THAT(read("a.pts", "2\n0 0 0\n1 0 0\n1\n2 0 0\n").cloud.scans, ElementsAre(0, 0, 1));
  EXPECT_THAT(read("a.csv", "scan,x,y,z\n9,0,0,0\n4,1,0,0\n9,1,1,0\n").cloud.scans, ElementsAre(0, 1, 0));
  EXPECT_THAT(read("a.las", las(false)).cloud.scans, ElementsAre(0, 0, 1, 1));
  EXPECT_TRUE(read("a.xyz", "0 0 0\n1 0 0\n").cloud.scans.empty()) << "a single scan has no number";
  write_bytes(folder / "b.xyz", "5 0 0\n");
  write_bytes(folder / "c.pts", "1\n6 0 0\n1\n7 0 0\n");
  const CloudInput several = read_cloud(std::vector{folder / "b.xyz", folder / "c.pts", folder / "b.xyz"});
  EXPECT_THAT(several.cloud.scans, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(codes(several), ElementsAre("read.no_count", "read.no_count", "read.scans"));
  EXPECT_EQ(several.sources.size(), 3u);
}

TEST_F(ReadCloud, KeepsOfSeveralFilesOnlyWhatAllHave) {
  write_bytes(folder / "a.xyz", "0 0 0 0 0 1\n");
  write_bytes(folder / "b.xyz", "1 0 0\n");
  const CloudInput input = read_cloud(std::vector{folder / "a.xyz", folder / "b.xyz"});
  EXPECT_EQ(input.cloud.points.size(), 2u);
  EXPECT_TRUE(input.cloud.normals.empty());
  EXPECT_THAT(codes(input), ElementsAre("read.no_count", "read.no_count", "read.normals_dropped", "read.scans"));
}

TEST_F(ReadCloud, RefusesBlocksThatHoldLessOrMoreThanTheyDeclare) {
  EXPECT_THAT(refusal("a.pts", "3\n0 0 0\n1 0 0\n"), HasSubstr("2 points in this block; 3 were declared"));
  EXPECT_THAT(refusal("a.pts", "1\n0 0 0\n1 0 0\n"), HasSubstr("1 were declared"));
  EXPECT_THAT(refusal("a.pts", "4294967295\n0 0 0\n"), HasSubstr("4294967295 were declared"));
  EXPECT_THAT(refusal("a.pts", "-3\n0 0 0\n"), HasSubstr("line 1"));
  EXPECT_THAT(refusal("a.pts", "0\n"), HasSubstr("holds no point"));
}

TEST_F(ReadCloud, RefusesRowsThatAreFewerThanTheirCommentsTell) {
  EXPECT_THAT(refusal("a.xyz", "# 3 points\n0 0 0\n1 0 0\n"), HasSubstr("holds 2 points; its first lines tell of 3"));
  EXPECT_THAT(refusal("a.csv", "// rows: 2\nx,y,z\n0,0,0\n"), HasSubstr("holds 1 rows"));
  EXPECT_TRUE(codes(read("a.xyz", "# 2 points\n0 0 0\n1 0 0\n")).empty());
  EXPECT_THAT(codes(read("a.xyz", "0 0 0\n1 0 0\n")), ElementsAre("read.no_count"));
}

TEST_F(ReadCloud, OfSeveralScansMissesOnlyACutBetweenThem) {
  const std::string first = "2\n0 0 0\n1 0 0\n", both = first + "1\n2 0 0\n";
  std::vector<std::size_t> accepted;
  for (std::size_t size = 0; size < both.size(); ++size)
    if (refusal("a.pts", std::string_view(both).substr(0, size)).empty()) accepted.push_back(size);
  // And what lacks a line break alone, which is told.
  EXPECT_EQ(accepted, (std::vector{first.size() - 1, first.size(), both.size() - 1}));
}

TEST_F(ReadCloud, RefusesWhatNeedsMoreMemoryThanTheLimit) {
  std::string rows;
  for (int n = 0; n < 400'000; ++n) rows += "0 0 " + std::to_string(n) + "\n";
  ASSERT_EQ(refusal("a.xyz", rows), "");
  const MemoryLimit limit(std::uint64_t{100} << 20);
  EXPECT_THAT(refusal("a.xyz", rows), HasSubstr("400000 points; the limit is 100 MiB (--memory-limit)"));
}

TEST_F(ReadCloud, RefusesLasFilesThatLie) {
  const auto changed = [](std::size_t place, auto value) {
    std::string bytes = las(true);
    std::memcpy(bytes.data() + place, &value, sizeof value);
    return bytes;
  };
  EXPECT_THAT(refusal("a.las", changed(0, 'X')), HasSubstr("begins with 'LASF'"));
  EXPECT_THAT(refusal("a.las", changed(25, std::uint8_t{5})), HasSubstr("version 1.5"));
  EXPECT_THAT(refusal("a.las", changed(104, std::uint8_t{0x87})), HasSubstr("no header of LASzip"));
  EXPECT_THAT(refusal("a.las", changed(104, std::uint8_t{11})), HasSubstr("point format 11"));
  EXPECT_THAT(refusal("a.las", changed(105, std::uint16_t{10})), HasSubstr("format 7 needs 36"));
  EXPECT_THAT(refusal("a.las", changed(247, std::uint64_t{1} << 60)), HasSubstr("points of 36 bytes are declared"));
  EXPECT_THAT(refusal("a.las", changed(107, std::uint32_t{5})), HasSubstr("counts of points differ"));
  EXPECT_THAT(refusal("a.las", changed(96, std::uint32_t{100})), HasSubstr("overlap"));
  EXPECT_THAT(refusal("a.las", changed(131, std::nan(""))), HasSubstr("not a finite number"));
  EXPECT_THAT(refusal("a.laz", "x"), HasSubstr("begins with 'LASF'"));
}

TEST_F(ReadCloud, LeavesOutLasPointsMarkedAsNoise) {
  std::string bytes = las(false);
  bytes[227 + 10 + 26 + 15] = 7;                           // low noise
  bytes[227 + 10 + 52 + 15] = static_cast<char>(128 + 2);  // ground, withheld
  const CloudInput input = read("a.las", bytes);
  EXPECT_EQ(input.cloud.points.size(), 2u);
  EXPECT_THAT(codes(input), ElementsAre("read.left_out", "read.scans"));
}

TEST_F(ReadCloud, SamplesASurfaceEvenlyWithItsVerticesFirst) {
  const TriMesh ball = test::lopsided_ball(3);
  for (const MeshFormat format : {MeshFormat::ply, MeshFormat::obj, MeshFormat::off, MeshFormat::stl}) {
    const auto path = folder / ("ball." + std::string(word_of(format)));
    write_mesh(ball, path, format);
    const CloudInput input = read_cloud(std::vector{path});
    ASSERT_EQ(input.cloud.points.size(), points_of_a_surface);
    EXPECT_EQ(input.sources[0].triangles, ball.triangles.size());
    EXPECT_THAT(codes(input), ElementsAre("read.sampled"));
    if (format != MeshFormat::stl) {
      EXPECT_TRUE(std::equal(ball.vertices.begin(), ball.vertices.end(), input.cloud.points.begin()));
    }
    // Normals point away from the middle of a ball.
    ASSERT_EQ(input.cloud.normals.size(), points_of_a_surface);
    std::size_t outwards = 0;
    for (std::size_t n = 0; n < points_of_a_surface; ++n)
      outwards += input.cloud.normals[n].dot(input.cloud.points[n] - Vec3(12.3, -45.6, 78.9)) > 0;
    EXPECT_EQ(outwards, points_of_a_surface);
  }
}

TEST_F(ReadCloud, ColoursTheSamplesOfAColouredSurface) {
  const CloudInput input = read("a.ply",
                                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                                "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                "0 0 0 0 0 40\n1 0 0 200 0 40\n0 1 0 0 100 40\n3 0 1 2\n");
  ASSERT_EQ(input.cloud.colours.size(), points_of_a_surface);
  for (std::size_t n = 0; n < input.cloud.points.size(); n += 997) {
    // Linear between the corners, to the rounding of a byte.
    EXPECT_NEAR(input.cloud.colours[n][0], 200 * input.cloud.points[n][0], 0.51);
    EXPECT_NEAR(input.cloud.colours[n][1], 100 * input.cloud.points[n][1], 0.51);
    EXPECT_EQ(input.cloud.colours[n][2], 40);
  }
}

TEST_F(ReadCloud, GivesNoNormalsToASurfaceThatIsNotOriented) {
  const CloudInput input =
      read("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 1 2 3\n");  // both run from 1 to 2
  EXPECT_EQ(input.cloud.points.size(), points_of_a_surface);
  EXPECT_TRUE(input.cloud.normals.empty());
}

TEST_F(ReadCloud, LeavesOutTrianglesWithACornerThatIsNowhere) {
  const CloudInput input = read("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\nnan 1 0\n3 0 1 2\n3 2 1 3\n");
  EXPECT_THAT(codes(input), ElementsAre("read.left_out", "read.sampled"));
  for (const Vec3& p : input.cloud.points) ASSERT_TRUE(p.allFinite());
  EXPECT_THAT(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\nnan 1 0\n3 0 1 2\n"), HasSubstr("no triangle with finite"));
}

TEST_F(ReadCloud, NamesTheFileThatCannotBeRead) {
  EXPECT_THROW(read_cloud(std::vector{folder / "absent.ply"}), IoError);
  EXPECT_THROW(read_cloud({}), InputError);
  EXPECT_THAT(refusal("a.e57", "x"), HasSubstr("expected an E57 file, which begins with 'ASTM-E57'"));
  EXPECT_THAT(refusal("a.bin", "x"), HasSubstr("unknown kind of cloud; expected a name that ends in .ply"));
  EXPECT_THAT(refusal("a.xyz", ""), HasSubstr("a.xyz: holds no point"));
  EXPECT_THAT(refusal("a.xyz", "# nothing\n"), HasSubstr("holds no point"));
}

TEST_F(ReadCloud, ReadsBackWhatWasWritten) {
  const PointCloud cloud{four_points, four_normals, four_colours, {0, 1, 1, 0}};
  write_cloud(cloud, folder / "a.ply");
  const PointCloud again = read_cloud(std::vector{folder / "a.ply"}).cloud;
  EXPECT_EQ(again.points, cloud.points);
  for (std::size_t n = 0; n < 4; ++n) EXPECT_LE((again.normals[n] - cloud.normals[n]).norm(), 1e-7) << "floats";
  EXPECT_EQ(again.colours, cloud.colours);
  EXPECT_EQ(again.scans, cloud.scans);
  EXPECT_THROW(write_cloud({}, folder / "b.ply"), InputError);
  EXPECT_THROW(write_cloud({four_points, {four_normals[0]}, {}, {}}, folder / "b.ply"), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.ply"));
}

}  // namespace
}  // namespace dynasurf::io
