#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/detail/text_reader.hpp"
#include "dynasurf/io/detail/told_counts.hpp"

namespace dynasurf::io::detail {

std::string encode_obj(const TriMesh& mesh, const VertexColours& colours) {
  // The counts tell a whole file from one that was cut at the end of a line.
  std::string out = "# SPACE=LPS\n# dynasurf, patient coordinates (LPS, mm) or those of the scan\n# Vertices: " +
                    std::to_string(mesh.vertices.size()) + "\n# Faces: " + std::to_string(mesh.triangles.size()) + "\n";
  const auto add_row = [&](const char* keyword, const auto& row) {
    out += keyword;
    for (const auto c : row) {
      out += ' ';
      append_text(out, c);
    }
    out += '\n';
  };
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    add_row("v", mesh.vertices[v]);
    if (colours.empty()) continue;
    out.pop_back();
    for (const std::uint8_t c : colours[v]) {
      out += ' ';
      append_text(out, std::round(c / 255.0 * 1e4) / 1e4);
    }
    out += '\n';
  }
  for (const auto& n : normals_to_write(mesh)) add_row("vn", n);
  for (const auto& t : mesh.triangles) {
    out += 'f';
    for (const auto v : t) {
      out += ' ';
      append_text(out, v + 1);
      out += "//";
      append_text(out, v + 1);
    }
    out += '\n';
  }
  return out;
}

namespace {

/// Keywords that describe no surface of polygons, only its looks and names, or points and lines.
constexpr std::string_view skipped[] = {"o",      "g",          "s", "mg", "mtllib", "usemtl",   "maplib",
                                        "usemap", "vp",         "l", "p",  "lod",    "c_interp", "d_interp",
                                        "bevel",  "shadow_obj", "#", "",   "mtl",    "call",     "trace_obj"};

/// How many v, vt, vn rows there are, and the largest index a face asks for. Faces may stand before their vertices, so
/// only the end of the file shows whether an index is too large.
struct Rows {
  std::size_t count = 0, largest = 0, line_of_largest = 0;
};
struct Tables {
  std::array<Rows, 3> rows;  // v, vt, vn
};

/// 0-based index for an index of the file: 1 is the first row, -1 the latest.
std::size_t resolve(const TextReader& text, Rows& rows, std::string_view word) {
  const auto index = text.number_of<std::int64_t>(word, "an index");
  if (index == 0) text.fail("index 0; expected 1 for the first, or -1 for the latest");
  if (index < 0) {
    // 0 - (index + 1) cannot overflow, -index could.
    const std::uint64_t back = -(index + 1);
    if (back >= rows.count)
      text.fail("index " + std::string(word) + " is out of range; expected -1 to -" + std::to_string(rows.count));
    return rows.count - 1 - back;
  }
  if (static_cast<std::size_t>(index) > rows.largest) {
    rows.largest = index;
    rows.line_of_largest = text.line_number();
  }
  return static_cast<std::size_t>(index) - 1;
}

/// One corner: v, v/vt, v//vn or v/vt/vn. Gives the vertex; the others are only checked.
std::uint32_t read_corner(const TextReader& text, Tables& tables, std::string_view corner) {
  const std::string_view whole = corner;
  std::size_t vertex = 0;
  for (std::size_t part = 0;; ++part) {
    const std::size_t slash = corner.find('/');
    const std::string_view word = corner.substr(0, slash);
    if (part > 2) text.fail(quoted(whole) + " is no corner; expected v, v/vt, v//vn or v/vt/vn");
    if (!(part == 1 && word.empty() && slash != std::string_view::npos)) {
      const std::size_t index = resolve(text, tables.rows[part], word);
      if (part == 0) vertex = index;
    }
    if (slash == std::string_view::npos) break;
    corner.remove_prefix(slash + 1);
  }
  if (vertex > 0xffffffffu) text.fail("index " + quoted(whole) + " is out of range");
  return vertex;
}

/// Vertices with a weight, or with a colour as some scanners write it.
void read_vertex(TextReader& text, TriMesh& mesh, VertexData* data) {
  Vec3 p;
  for (double& c : p) c = data == nullptr ? text.coordinate() : text.number<double>("a coordinate");
  std::array<double, 4> extra{};
  std::size_t count = 0;
  while (!text.line_is_done() && count < 5) {
    const double value = text.number<double>("a weight or colour");
    if (count < extra.size()) extra[count] = value;
    ++count;
  }
  if (count == 2 || count > 4) text.fail("expected 3 coordinates, and at most a weight or a colour");
  if (data != nullptr && count >= 3) {
    // A file colours all its vertices or none.
    if (data->colours.size() != mesh.vertices.size()) text.fail("a coloured vertex after some without colour");
    auto& colour = data->colours.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const double light = extra[c + count - 3];
      if (!(light >= 0 && light <= 1)) text.fail("a colour is out of range; expected 0 to 1");
      colour[c] = colour_byte(light, 1);
    }
  } else if (data != nullptr && !data->colours.empty()) {
    text.fail("a vertex without colour after coloured ones");
  }
  mesh.vertices.push_back(p);
}

void read_normal(TextReader& text, VertexData& data) {
  Vec3 n;
  for (double& c : n) c = text.number<double>("a normal");
  if (!text.line_is_done()) text.fail("expected a normal of 3 numbers");
  data.normals.push_back(n);
}

void read_face(TextReader& text, Tables& tables, std::vector<std::uint32_t>& corners, TriMesh& mesh, MeshRoom& room) {
  corners.clear();
  for (auto word = text.word(); !word.empty(); word = text.word()) corners.push_back(read_corner(text, tables, word));
  if (corners.size() < 3) text.fail("a face of " + std::to_string(corners.size()) + " corners; expected 3 or more");
  room.before_more(mesh, corners.size());
  add_fan(mesh, corners);
}

TriMesh decode(const MeshFile& file, VertexData* data) {
  TriMesh mesh;
  Tables tables;
  std::vector<std::uint32_t> corners;
  const ToldCounts told = told_counts(file);
  std::size_t faces = 0;
  MeshRoom room(file, data != nullptr);
  TextReader text(file);
  while (text.next_line_with_words('#')) {
    const auto keyword = text.word();
    if (keyword == "v") {
      room.before_more(mesh, 0);
      read_vertex(text, mesh, data);
      tables.rows[0].count = mesh.vertices.size();
    } else if (keyword == "vt" || keyword == "vn") {
      ++tables.rows[keyword == "vt" ? 1 : 2].count;
      if (data != nullptr && keyword == "vn") {
        read_normal(text, *data);
        continue;
      }
      text.number<double>("a value");
      while (!text.line_is_done()) text.number<double>("a value");
    } else if (keyword == "f") {
      read_face(text, tables, corners, mesh, room);
      ++faces;
    } else if (std::find(std::begin(skipped), std::end(skipped), keyword) == std::end(skipped)) {
      text.fail(quoted(keyword) + " is not supported; expected a Wavefront OBJ of polygons");
    }
  }
  require_told(file, told.points, mesh.vertices.size(), "vertices");
  require_told(file, told.faces, faces, "faces");
  if (data != nullptr) data->has_count = told.points && (told.faces || faces == 0);
  constexpr const char* names[] = {"vertices", "texture coordinates", "normals"};
  for (std::size_t i = 0; i < 3; ++i)
    if (const Rows& rows = tables.rows[i]; rows.largest > rows.count)
      refuse(file, "line", rows.line_of_largest,
             "index " + std::to_string(rows.largest) + " is out of range; the file has " + std::to_string(rows.count) +
                 " " + names[i]);
  // Faces say which normal belongs to which corner; without faces the n-th belongs to the n-th vertex.
  if (data != nullptr && (!mesh.triangles.empty() || data->normals.size() != mesh.vertices.size()))
    data->normals.clear();
  return mesh;
}

}  // namespace

TriMesh decode_obj(const MeshFile& file) { return decode(file, nullptr); }
TriMesh decode_obj(const MeshFile& file, VertexData& data) { return decode(file, &data); }

}  // namespace dynasurf::io::detail
