#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <random>
#include <unordered_map>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/detail/text_reader.hpp"

namespace dynasurf::io::detail {
namespace {

constexpr std::size_t title_bytes = 80, head_bytes = 84, triangle_bytes = 50;

using Corner = std::array<std::uint64_t, 3>;  // the bits of its coordinates

struct CornerHash {
  std::uint64_t seed;
  std::size_t operator()(const Corner& corner) const {
    std::uint64_t h = seed;
    for (const auto part : corner) h = (h ^ part ^ (part >> 32)) * 0x9e3779b97f4a7c15u;
    return h ^ (h >> 29);
  }
};

/// Gives equal corners one vertex, numbered in the order in which they are first seen.
class Weld {
 public:
  std::uint32_t vertex(const Vec3& p, TriMesh& mesh) {
    const auto [entry, is_new] =
        seen_.try_emplace({key(p[0]), key(p[1]), key(p[2])}, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(p);
    return entry->second;
  }

 private:
  /// Drawn once in each run, so that no file can be made whose corners all fall together. The order of the vertices
  /// does not depend on it.
  static CornerHash any_hash() {
    static const std::uint64_t seed = [] {
      std::random_device device;
      return std::uint64_t{device()} << 32 | device();
    }();
    return {seed};
  }
  static std::uint64_t key(double c) { return std::bit_cast<std::uint64_t>(c == 0 ? 0.0 : c); }  // -0 is 0
  std::unordered_map<Corner, std::uint32_t, CornerHash> seen_{16, any_hash()};
};

TriMesh decode_binary(const MeshFile& file, std::size_t count) {
  TriMesh mesh;
  mesh.triangles.reserve(count);
  Weld weld;
  for (std::size_t t = 0; t < count; ++t) {
    const std::size_t begin = head_bytes + t * triangle_bytes + 12;  // the stored normal is not needed
    std::array<std::uint32_t, 3> triangle;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Vec3 p;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t at = begin + 12 * corner + 4 * axis;
        p[axis] = load<float>(file.bytes.data() + at);
        if (!std::isfinite(p[axis])) refuse(file, "byte", at, "a coordinate is not a finite number");
      }
      triangle[corner] = weld.vertex(p, mesh);
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

/// `lower` is in lower case, the file's word may be in any.
bool same_word(std::string_view found, std::string_view lower) {
  return std::equal(found.begin(), found.end(), lower.begin(), lower.end(),
                    [](unsigned char a, char b) { return std::tolower(a) == b; });
}

void expect(TextReader& text, std::initializer_list<std::string_view> words) {
  for (const std::string_view expected : words) {
    const std::string_view found = text.word();
    if (!same_word(found, expected))
      text.fail(quoted(found) + " stands where an ascii STL has '" + std::string(expected) + "'");
  }
}

void next_line(TextReader& text) {
  if (!text.next_line_with_words()) text.fail("the file ends before its endsolid");
}

void finish_line(TextReader& text) {
  if (!text.line_is_done()) text.fail("expected nothing after this");
}

void read_facet(TextReader& text, Weld& weld, TriMesh& mesh) {
  expect(text, {"normal"});
  for (int axis = 0; axis < 3; ++axis) text.number<double>("the normal");  // may be nan for a flat triangle: not used
  finish_line(text);
  next_line(text);
  expect(text, {"outer", "loop"});
  std::array<std::uint32_t, 3> triangle;
  for (auto& corner : triangle) {
    next_line(text);
    expect(text, {"vertex"});
    Vec3 p;
    for (double& c : p) c = text.coordinate();
    finish_line(text);
    corner = weld.vertex(p, mesh);
  }
  next_line(text);
  expect(text, {"endloop"});
  next_line(text);
  expect(text, {"endfacet"});
  mesh.triangles.push_back(triangle);
}

TriMesh decode_ascii(const MeshFile& file, bool as_cloud) {
  TriMesh mesh;
  MeshRoom room(file, as_cloud);
  Weld weld;
  TextReader text(file);
  while (text.next_line_with_words()) {  // some files hold several solids
    expect(text, {"solid"});
    while (true) {
      next_line(text);
      const std::string_view word = text.word();
      if (same_word(word, "endsolid")) break;
      if (!same_word(word, "facet")) text.fail(quoted(word) + " stands where an ascii STL has 'facet' or 'endsolid'");
      room.before_more(mesh);
      read_facet(text, weld, mesh);
    }
  }
  return mesh;
}

}  // namespace

std::string encode_stl(const TriMesh& mesh) {
  std::string out = "Dynasurf binary STL, SPACE=LPS, patient coordinates, mm, or those of the scan";
  out.resize(title_bytes, ' ');
  out.reserve(head_bytes + triangle_bytes * mesh.triangles.size());
  append(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const Vec3 normal = (q - p).cross(r - p).stableNormalized();  // zero for a flat triangle, as the format asks
    for (const Vec3* row : {&normal, &p, &q, &r})
      for (const double x : *row) append(out, static_cast<float>(x));
    append(out, std::uint16_t{0});
  }
  return out;
}

/// Binary files are known by their size, which follows from the count they declare; the word 'solid' says nothing,
/// because many programs begin binary files with it.
TriMesh decode_stl(const MeshFile& file, bool as_cloud) {
  if (file.bytes.size() >= head_bytes) {
    const std::size_t count = load<std::uint32_t>(file.bytes.data() + title_bytes);
    if (file.bytes.size() == head_bytes + count * triangle_bytes) {
      require_memory_of(file, count / 2, count, as_cloud);
      return decode_binary(file, count);
    }
  }
  std::size_t begin = 0;
  while (begin < file.bytes.size() && (is_blank(file.bytes[begin]) || file.bytes[begin] == '\n')) ++begin;
  if (!same_word(file.bytes.substr(begin, 5), "solid"))
    refuse(file, "", 0,
           "neither a binary STL (84 bytes and 50 for each triangle declared in byte 80) nor an ascii one ('solid')");
  return decode_ascii(file, as_cloud);
}

TriMesh decode_stl(const MeshFile& file) { return decode_stl(file, false); }

}  // namespace dynasurf::io::detail
