#include <algorithm>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/detail/text_reader.hpp"

namespace dynasurf::io::detail {

std::string encode_off(const TriMesh& mesh, const VertexColours& colours) {
  std::string out = std::string(colours.empty() ? "OFF" : "COFF") +
                    "\n# dynasurf, patient coordinates (LPS, mm) or those of the scan\n";
  out += std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n";
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      append_text(out, mesh.vertices[v][axis]);
      if (axis < 2) out += ' ';
    }
    if (!colours.empty())
      for (const std::uint8_t c : colours[v]) out += " " + std::to_string(c);
    out += '\n';
  }
  for (const auto& t : mesh.triangles)
    out += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  return out;
}

namespace {

void next_row(TextReader& text, const char* what) {
  if (!text.next_line_with_words('#')) text.fail(std::string("the file ends before its last ") + what);
}

/// Normals, texture coordinates and colours behind a vertex or a face: numbers, not used.
void skip_numbers(TextReader& text) {
  while (!text.line_is_done()) text.number<double>("a colour or normal");
}

struct Counts {
  std::size_t vertices, faces;
  bool normals, colours;  // behind each vertex
};

Counts read_counts(TextReader& text) {
  if (!text.next_line_with_words('#')) text.fail("expected an OFF file, which begins with a line 'OFF'");
  const auto word = text.word();
  if (word != "OFF" && word != "COFF" && word != "NOFF" && word != "CNOFF" && word != "STOFF")
    text.fail("expected an ascii OFF file of three dimensions, which begins with OFF, COFF, NOFF, CNOFF or STOFF");
  Counts counts{};
  counts.normals = word == "NOFF" || word == "CNOFF";
  counts.colours = word == "COFF" || word == "CNOFF";
  if (text.line_is_done()) next_row(text, "vertex");
  counts.vertices = text.number<std::uint32_t>("the number of vertices");
  counts.faces = text.number<std::uint32_t>("the number of faces");
  if (!text.line_is_done()) text.number<std::uint32_t>("the number of edges");
  if (!text.line_is_done()) text.fail("expected the numbers of vertices, faces and edges, and no more");
  // "0 0 0\n" and "3 0 0 0\n" are the shortest rows.
  if (6 * counts.vertices + 8 * counts.faces > text.bytes_left())
    text.fail(std::to_string(counts.vertices) + " vertices and " + std::to_string(counts.faces) +
              " faces; the file has only " + std::to_string(text.bytes_left()) + " bytes for them");
  return counts;
}

/// The normal and the colour that the first word of the file promises. Colours are integers to 255 or reals to 1.
void read_data(TextReader& text, const Counts& counts, VertexData& data) {
  if (counts.normals) {
    Vec3 n;
    for (double& c : n) c = text.number<double>("a normal");
    data.normals.push_back(n);
  }
  if (!counts.colours) return;
  auto& colour = data.colours.emplace_back();
  std::array<std::string_view, 3> words;
  for (auto& word : words) word = text.word();
  const bool real = std::any_of(words.begin(), words.end(), [](std::string_view word) {
    return word.find_first_of(".eE") != std::string_view::npos;
  });
  for (std::size_t c = 0; c < 3; ++c) {
    const double light = text.number_of<double>(words[c], "a colour"), full = real ? 1 : 255;
    if (!(light >= 0 && light <= full)) text.fail("a colour is out of range; expected integers to 255 or reals to 1");
    colour[c] = colour_byte(light, full);
  }
}

void read_face(TextReader& text, std::vector<std::uint32_t>& corners, TriMesh& mesh, MeshRoom& room) {
  const std::size_t count = text.number<std::uint32_t>("the number of corners");
  if (count < 3) text.fail("a face of " + std::to_string(count) + " corners; expected 3 or more");
  corners.clear();
  for (std::size_t i = 0; i < count; ++i) {
    corners.push_back(text.number<std::uint32_t>("a vertex index"));
    if (corners.back() >= mesh.vertices.size())
      text.fail("vertex index " + std::to_string(corners.back()) + " is out of range; the file has " +
                std::to_string(mesh.vertices.size()) + " vertices");
  }
  skip_numbers(text);
  room.before_more(mesh, corners.size());
  add_fan(mesh, corners);
}

TriMesh decode(const MeshFile& file, VertexData* data) {
  TextReader text(file);
  const Counts counts = read_counts(text);
  require_memory_of(file, counts.vertices, counts.faces, data != nullptr);
  TriMesh mesh;
  mesh.vertices.reserve(counts.vertices);
  mesh.triangles.reserve(counts.faces);
  for (std::size_t i = 0; i < counts.vertices; ++i) {
    next_row(text, "vertex");
    Vec3 p;
    for (double& c : p) c = data == nullptr ? text.coordinate() : text.number<double>("a coordinate");
    if (data != nullptr) read_data(text, counts, *data);
    skip_numbers(text);
    mesh.vertices.push_back(p);
  }
  std::vector<std::uint32_t> corners;
  MeshRoom room(file, data != nullptr);
  for (std::size_t i = 0; i < counts.faces; ++i) {
    next_row(text, "face");
    read_face(text, corners, mesh, room);
  }
  if (text.next_line_with_words('#')) text.fail("expected nothing after the last face");
  return mesh;
}

}  // namespace

TriMesh decode_off(const MeshFile& file) { return decode(file, nullptr); }
TriMesh decode_off(const MeshFile& file, VertexData& data) { return decode(file, &data); }

}  // namespace dynasurf::io::detail
