#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/mesh_io.hpp"

#include "support/damage.hpp"
#include "support/sample_meshes.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using detail::append;
using detail::MeshFile;
using test::ScratchFolder;
using test::write_bytes;
using ::testing::HasSubstr;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

using Decoder = TriMesh (*)(const MeshFile&);

TriMesh decode(Decoder decoder, std::string_view bytes) { return decoder(MeshFile{"file", bytes}); }

/// The message with which a decoder refuses; empty when it does not.
std::string refusal(Decoder decoder, std::string_view bytes) {
  try {
    decode(decoder, bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// A pyramid with a square base, in every dialect: 5 vertices, 1 square and 4 triangles, outwards.
const std::vector<Vec3> pyramid_vertices{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 3}};
const Triangles pyramid_triangles{{0, 3, 2}, {0, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};

const std::string pyramid_ply_ascii =
    "ply\nformat ascii 1.0\ncomment by hand\nobj_info x\nelement vertex 5\nproperty float x\nproperty float y\n"
    "property uchar red\nproperty double z\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n"
    "element face 5\nproperty uchar flags\nproperty list uchar int vertex_index\nend_header\n"
    "0 0 255 0\n2 0 255 0\n2 2 255 0\n0 2 255 0\n1 1 255 3.0e0\n0 1\n"
    "7 4 0 3 2 1\n7 3 0 1 4\n7 3 1 2 4\n7 3 2 3 4\n7 3 3 0 4\n";

std::string pyramid_ply_binary(bool big_endian) {
  std::string out = "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
                    "_endian 1.0\nelement face 5\nproperty list ushort uint vertex_indices\n"
                    "property list uchar float texcoord\nelement vertex 5\nproperty short z\nproperty float x\n"
                    "property double y\nend_header\n";
  const auto put = [&](auto number) {
    std::string bytes;
    append(bytes, number);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  };
  const std::vector<std::vector<std::uint32_t>> faces{{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  for (const auto& face : faces) {
    put(static_cast<std::uint16_t>(face.size()));
    for (const auto v : face) put(v);
    put(std::uint8_t{2});
    put(0.5f);
    put(1.5f);
  }
  for (const Vec3& p : pyramid_vertices) {
    put(static_cast<std::int16_t>(p[2]));
    put(static_cast<float>(p[0]));
    put(p[1]);
  }
  return out;
}

const std::string pyramid_obj =
    "# a pyramid\nmtllib none.mtl\no pyramid\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0 1.0\nv 1 1 3 0.1 0.2 0.3\n"
    "vt 0 0\nvn 0 0 1\ns off\nf 1 4 3 2\nf 1/1 2/1 5/1\nf -4//-1 -3//1 -1//1\nf 3/1/1 4/-1/-1 5/1/1\nf 4 1 5 # last\n";

const std::string pyramid_off =
    "COFF 5 5 0\n\n# corners\n0 0 0 255 0 0 255\n2 0 0\n2 2 0\n0 2 0\n1 1 3\n4 0 3 2 1 0.5 0.5 0.5\n3 0 1 4\n3 1 2 4\n"
    "3 2 3 4\n3 3 0 4\n";

const std::string triangle_stl_ascii =
    "solid by hand\n  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n"
    "      vertex 0 1 0\n    endloop\n  endfacet\nfacet normal nan nan nan\nouter loop\nvertex 1 0 0\nvertex 1 1 0\n"
    "vertex -0.0 1e0 0\nendloop\nendfacet\nendsolid by hand\n";

std::string two_triangles_stl_binary() {
  std::string out(80, 'x');
  std::copy_n("solid", 5, out.begin());  // many exporters do this
  append(out, std::uint32_t{2});
  const float corners[2][9] = {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {1, 0, 0, 1, 1, 0, -0.0f, 1, 0}};
  for (const auto& triangle : corners) {
    for (int i = 0; i < 3; ++i) append(out, 7.0f);
    for (const float c : triangle) append(out, c);
    append(out, std::uint16_t{0});
  }
  return out;
}

struct Dialect {
  const char* name;
  Decoder decoder;
  std::string bytes;
  bool has_counts;  // a shorter file cannot pass for a whole one
};

std::vector<Dialect> dialects() {
  using namespace detail;
  return {{"ascii PLY", decode_ply, pyramid_ply_ascii, true},
          {"little-endian PLY", decode_ply, pyramid_ply_binary(false), true},
          {"big-endian PLY", decode_ply, pyramid_ply_binary(true), true},
          {"ascii STL", decode_stl, triangle_stl_ascii, true},
          {"binary STL", decode_stl, two_triangles_stl_binary(), true},
          {"OFF", decode_off, pyramid_off, true},
          {"OBJ", decode_obj, pyramid_obj, false}};
}

TEST(ReadMesh, ReadsTheSamePyramidFromEveryDialect) {
  for (const Dialect& d : dialects()) {
    if (d.decoder == static_cast<Decoder>(detail::decode_stl)) continue;
    const TriMesh mesh = decode(d.decoder, d.bytes);
    EXPECT_EQ(mesh.vertices, pyramid_vertices) << d.name;
    EXPECT_EQ(mesh.triangles, pyramid_triangles) << d.name;
  }
}

TEST(ReadMesh, WeldsTheCornersOfAnStlInTheOrderTheyAreSeen) {
  for (const std::string& bytes : {triangle_stl_ascii, two_triangles_stl_binary()}) {
    const TriMesh mesh = decode(detail::decode_stl, bytes);
    EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {1, 3, 2}}));
  }
}

TEST(ReadMesh, ReadsSeveralSolidsAndCapitalLetters) {
  std::string capitals = triangle_stl_ascii;
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const TriMesh mesh = decode(detail::decode_stl, capitals + triangle_stl_ascii);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(mesh.vertices.size(), 4u);
}

TEST(ReadMesh, ReadsLinesThatEndTheWayOfWindows) {
  for (const Dialect& d : dialects()) {
    if (d.bytes.find('\0') != std::string::npos) continue;
    std::string windows;
    for (const char c : d.bytes) windows += c == '\n' ? "\r\n" : std::string(1, c);
    EXPECT_EQ(decode(d.decoder, windows).triangles, decode(d.decoder, d.bytes).triangles) << d.name;
  }
}

TEST(ReadMesh, RefusesAFileCutAnywhere) {
  for (const Dialect& d : dialects()) {
    ASSERT_EQ(refusal(d.decoder, d.bytes), "") << d.name;
    for (std::size_t size = 0; size < d.bytes.size(); ++size) {
      // An OBJ declares no counts: cut at the end of a line it is a smaller OBJ, and nobody can tell.
      if (!d.has_counts && (size == 0 || d.bytes[size - 1] == '\n')) continue;
      const std::string reason = refusal(d.decoder, std::string_view(d.bytes).substr(0, size));
      EXPECT_THAT(reason, HasSubstr("file: ")) << d.name << " cut to " << size << " bytes";
      EXPECT_EQ(reason.find('\n'), std::string::npos);
    }
  }
}

TEST(ReadMesh, RefusesAnObjCutAnywhereWhenItsCommentsTellTheCounts) {
  const std::string whole = detail::encode_obj(decode(detail::decode_obj, pyramid_obj));
  ASSERT_EQ(refusal(detail::decode_obj, whole), "");
  const std::size_t first_row = whole.find("\nv ") + 1;  // a cut before it leaves no mesh at all
  for (std::size_t size = first_row; size < whole.size(); ++size)
    EXPECT_NE(refusal(detail::decode_obj, std::string_view(whole).substr(0, size)), "") << size;
  for (const char* comment : {"# 6 vertices, 5 faces\n", "#number of vertices = 6\n", "# Points: 6\n", "# FACES 99\n"})
    EXPECT_THAT(refusal(detail::decode_obj, comment + pyramid_obj), HasSubstr("its first lines tell of")) << comment;
  for (const char* comment :
       {"# 4 vertices\n", "# 99 vertices were removed\n", "# 99 vertex normals\n", "# vertices\n"})
    EXPECT_EQ(refusal(detail::decode_obj, comment + pyramid_obj), "") << comment;
}

TEST(ReadMesh, OfAnAsciiStlWithSeveralSolidsMissesOnlyACutBetweenThem) {
  const std::string two = triangle_stl_ascii + triangle_stl_ascii;
  std::vector<std::size_t> accepted;
  for (std::size_t size = 1; size < two.size(); ++size)
    if (refusal(detail::decode_stl, std::string_view(two).substr(0, size)).empty()) accepted.push_back(size);
  EXPECT_EQ(accepted, std::vector{triangle_stl_ascii.size()});
}

TEST(ReadMesh, RefusesHeadersAndLinesAboveTheirLimits) {
  const auto with_properties = [](int count) {
    std::string ply =
        "ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int vertex_indices\n"
        "element vertex 0\nproperty float x\nproperty float y\nproperty float z\n";
    for (int n = 0; n < count - 3; ++n) ply += "property float p" + std::to_string(n) + "\n";
    return ply + "end_header\n";
  };
  EXPECT_EQ(refusal(detail::decode_ply, with_properties(1024)), "");
  EXPECT_THAT(refusal(detail::decode_ply, with_properties(1025)), HasSubstr("more than 1024 properties"));
  std::string elements = "ply\nformat ascii 1.0\n";
  for (int n = 0; n < 257; ++n) elements += "element e" + std::to_string(n) + " 0\n";
  EXPECT_THAT(refusal(detail::decode_ply, elements), HasSubstr("more than 256 elements"));
  const std::string line(std::size_t{1} << 20, ' ');
  EXPECT_EQ(refusal(detail::decode_off, line + "\n" + pyramid_off), "");
  EXPECT_THAT(refusal(detail::decode_off, line + " \n" + pyramid_off), HasSubstr("longer than 1048576 bytes"));
}

TEST(ReadMesh, RefusesWhatNeedsMoreMemoryThanTheLimit) {
  std::string stl(80, ' ');
  append(stl, std::uint32_t{1'000'000});
  stl.resize(84 + 50'000'000, '\0');
  ASSERT_EQ(refusal(detail::decode_stl, stl), "");
  const MemoryLimit limit(std::uint64_t{200} << 20);
  EXPECT_THAT(refusal(detail::decode_stl, stl), HasSubstr("1000000 triangles; the limit is 200 MiB"));
  std::string obj = "v 0 0 0\nf";
  for (int n = 0; n < 500'000; ++n) obj += " 1";  // a fan of so many triangles
  for (int n = 0; n < 4; ++n) obj += "\n" + obj.substr(obj.find('f'));
  EXPECT_THAT(refusal(detail::decode_obj, obj + "\n"), HasSubstr("the limit is 200 MiB"));
}

TEST(ReadMesh, RefusesWhatFollowsTheEnd) {
  for (const Dialect& d : dialects()) EXPECT_NE(refusal(d.decoder, d.bytes + "x"), "") << d.name;
}

TEST(ReadMesh, SurvivesThousandsOfDamagedFiles) {
  std::mt19937 random(20260101);
  std::size_t read = 0, refused = 0;
  for (const Dialect& d : dialects())
    for (int i = 0; i < 2000; ++i) {
      const std::string bytes = test::damaged(d.bytes, random);
      try {
        const TriMesh mesh = decode(d.decoder, bytes);
        ++read;
        for (const Vec3& p : mesh.vertices) ASSERT_TRUE(p.allFinite()) << d.name;
        for (const auto& t : mesh.triangles)
          for (const auto v : t) ASSERT_LT(v, mesh.vertices.size()) << d.name;
      } catch (const InputError& error) {
        ++refused;
        ASSERT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos) << error.what();
      }
    }
  // Both happen, or the damage would test nothing.
  EXPECT_GT(read, 100u);
  EXPECT_GT(refused, 1000u);
}

TEST(ReadMesh, RefusesAnIndexOutOfRangeAndNamesTheLine) {
  using namespace detail;
  EXPECT_THAT(refusal(decode_obj, replaced(pyramid_obj, "f 1/1 2/1 5/1", "f 1/1 2/1 6/1")),
              HasSubstr("line 13: index 6 is out of range; the file has 5 vertices"));
  EXPECT_THAT(refusal(decode_obj, replaced(pyramid_obj, "f 1/1 2/1 5/1", "f 1/2 2/1 5/1")),
              HasSubstr("line 13: index 2 is out of range; the file has 1 texture coordinates"));
  EXPECT_THAT(refusal(decode_obj, replaced(pyramid_obj, "-4//-1", "-6//-1")), HasSubstr("line 14: index -6"));
  EXPECT_THAT(refusal(decode_obj, replaced(pyramid_obj, "f 1 4 3 2", "f 0 4 3 2")), HasSubstr("line 12: index 0"));
  EXPECT_THAT(refusal(decode_off, replaced(pyramid_off, "3 1 2 4", "3 1 2 5")),
              HasSubstr("line 11: vertex index 5 is out of range"));
  EXPECT_THAT(refusal(decode_ply, replaced(pyramid_ply_ascii, "3 2 3 4", "3 2 3 5")),
              HasSubstr("line 26: vertex index 5 is out of range"));
  EXPECT_THAT(refusal(decode_ply, replaced(pyramid_ply_ascii, "3 2 3 4", "3 2 -1 4")), HasSubstr("vertex index -1"));
  std::string binary = pyramid_ply_binary(false);
  binary[binary.find("end_header\n") + 11 + 2] = 5;
  EXPECT_THAT(refusal(decode_ply, binary), HasSubstr("byte 209: vertex index 5 is out of range"));
}

TEST(ReadMesh, RefusesCoordinatesThatAreNoFiniteNumbers) {
  using namespace detail;
  for (const char* bad : {"nan", "inf", "-inf", "NaN", "1e999", "1.5.2", "0x10", "one"}) {
    EXPECT_NE(refusal(decode_obj, replaced(pyramid_obj, "v 2 0 0", std::string("v 2 ") + bad + " 0")), "") << bad;
    EXPECT_NE(refusal(decode_off, replaced(pyramid_off, "\n2 0 0", std::string("\n2 0 ") + bad)), "") << bad;
    EXPECT_NE(refusal(decode_ply, replaced(pyramid_ply_ascii, "\n2 0 ", std::string("\n2 ") + bad + " ")), "") << bad;
    EXPECT_NE(refusal(decode_stl, replaced(triangle_stl_ascii, "vertex 1 0", std::string("vertex 1 ") + bad)), "")
        << bad;
  }
  std::string stl = two_triangles_stl_binary();
  stl.replace(84 + 12 + 4, 4, std::string("\0\0\xc0\x7f", 4));
  EXPECT_THAT(refusal(decode_stl, stl), HasSubstr("byte 100: a coordinate is not a finite number"));
  std::string ply = pyramid_ply_binary(false);
  ply.replace(ply.size() - 8, 8, std::string("\0\0\0\0\0\0\xf0\x7f", 8));
  EXPECT_THAT(refusal(decode_ply, ply), HasSubstr("a coordinate is not a finite number"));
}

TEST(ReadMesh, RefusesCountsThatTheFileCannotHold) {
  using namespace detail;
  // Memory for 4294967295 vertices would be 100 GB: the refusal must come first, or this test dies.
  EXPECT_THAT(refusal(decode_ply, replaced(pyramid_ply_ascii, "vertex 5", "vertex 4294967295")), HasSubstr("line 5"));
  EXPECT_THAT(refusal(decode_ply, replaced(pyramid_ply_ascii, "face 5", "face 4294967295")), HasSubstr("element face"));
  EXPECT_THAT(refusal(decode_ply, replaced(pyramid_ply_binary(true), "vertex 5", "vertex 4294967295")),
              HasSubstr("rows of element vertex need at least"));
  EXPECT_THAT(refusal(decode_ply, replaced(pyramid_ply_ascii, "vertex 5", "vertex 99999999999")), HasSubstr("line 5"));
  EXPECT_THAT(refusal(decode_ply, replaced(pyramid_ply_ascii, "vertex 5", "vertex -5")), HasSubstr("line 5"));
  EXPECT_THAT(refusal(decode_ply, replaced(pyramid_ply_ascii, "7 4 0 3 2 1", "7 200 0 3 2 1")),
              HasSubstr("a list of 200 values"));
  EXPECT_THAT(
      refusal(decode_ply, replaced(pyramid_ply_ascii, "element edge 1\nproperty int vertex1\nproperty int vertex2",
                                   "element edge 4000000000")),
      HasSubstr("no property"));
  EXPECT_THAT(refusal(decode_off, replaced(pyramid_off, "5 5 0", "4294967295 5 0")), HasSubstr("line 1"));
  EXPECT_THAT(refusal(decode_off, replaced(pyramid_off, "4 0 3 2 1", "4000000000 0 3 2 1")), HasSubstr("line 9"));
  std::string stl = two_triangles_stl_binary();
  stl.replace(80, 4, "\xff\xff\xff\xff");
  EXPECT_NE(refusal(decode_stl, stl), "");
}

TEST(ReadMesh, RefusesFacesThatAreNone) {
  using namespace detail;
  EXPECT_THAT(refusal(decode_obj, replaced(pyramid_obj, "f 4 1 5 ", "f 4 1 ")), HasSubstr("a face of 2 corners"));
  EXPECT_THAT(refusal(decode_off, replaced(pyramid_off, "3 3 0 4", "2 3 0")), HasSubstr("a face of 2 corners"));
  EXPECT_THAT(refusal(decode_ply, replaced(pyramid_ply_ascii, "7 3 3 0 4", "7 2 3 0")),
              HasSubstr("a face of 2 corners"));
  EXPECT_THAT(refusal(decode_obj, replaced(pyramid_obj, "f 3/1/1", "f 3/1/1/1")), HasSubstr("no corner"));
  EXPECT_THAT(refusal(decode_obj, replaced(pyramid_obj, "f 3/1/1", "f 3/")), HasSubstr("line 15"));
}

TEST(ReadMesh, RefusesHeadersItDoesNotUnderstand) {
  using namespace detail;
  for (const auto& [from, to] :
       std::vector<std::pair<const char*, const char*>>{{"ply\n", "plx\n"},
                                                        {"ascii 1.0", "ascii 2.0"},
                                                        {"format ascii", "format binary"},
                                                        {"format ascii 1.0\n", ""},
                                                        {"float x", "float16 x"},
                                                        {"property float y", "property float x"},
                                                        {"property double z", "property double w"},
                                                        {"property double z", "property list uchar double z"},
                                                        {"element edge 1", "element vertex 1"},
                                                        {"element face 5", "element tristrips 5"},
                                                        {"list uchar int", "list float int"},
                                                        {"list uchar int", "list uchar float"},
                                                        {"end_header", "end_heading"},
                                                        {"comment", "commend"}})
    EXPECT_NE(refusal(decode_ply, replaced(pyramid_ply_ascii, from, to)), "") << from << " -> " << to;
  EXPECT_THAT(refusal(decode_off, replaced(pyramid_off, "COFF", "4OFF")), HasSubstr("three dimensions"));
  EXPECT_THAT(refusal(decode_off, replaced(pyramid_off, "COFF", "OFF BINARY")), HasSubstr("line 1"));
  EXPECT_THAT(refusal(decode_obj, replaced(pyramid_obj, "s off", "curv 0 1")), HasSubstr("'curv' is not supported"));
  EXPECT_NE(refusal(decode_stl, replaced(triangle_stl_ascii, "endloop", "vertex 1 1 1\nendloop")), "");
}

TEST(ReadMesh, NeverLetsAFileWriteControlCharactersToTheTerminal) {
  const std::string reason = refusal(detail::decode_obj, "\x1b[31mred\n");
  EXPECT_THAT(reason, HasSubstr("'?[31mred' is not supported"));
}

TEST(ReadMesh, NamesTheFileThatCannotBeRead) {
  const ScratchFolder folder;
  const auto reason = [&](const std::string& name) -> std::string {
    try {
      read_mesh(folder / name);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  };
  write_bytes(folder / "a.xyz", "1 2 3\n");
  write_bytes(folder / "empty.obj", "");
  write_bytes(folder / "points.obj", "v 1 2 3\n");
  write_bytes(folder / "UPPER.OBJ", pyramid_obj);
  std::filesystem::create_directory(folder / "folder.ply");
  EXPECT_THAT(reason("a.xyz"), HasSubstr("a.xyz: unknown kind of mesh"));
  EXPECT_THAT(reason("empty.obj"), HasSubstr("empty.obj: holds no triangle"));
  EXPECT_THAT(reason("points.obj"), HasSubstr("holds no triangle"));
  EXPECT_THAT(reason("folder.ply"), HasSubstr("not a regular file"));
  EXPECT_THAT(reason("absent.ply"), HasSubstr("absent.ply: cannot open: No such file"));
  EXPECT_THROW(read_mesh(folder / "absent.ply"), IoError);
  EXPECT_EQ(reason("UPPER.OBJ"), "");
}

}  // namespace
}  // namespace dynasurf::io
