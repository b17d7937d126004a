#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <set>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/detail/text_reader.hpp"

namespace dynasurf::io::detail {

std::string encode_ply(const TriMesh& mesh, std::span<const VertexScalar> scalars, const VertexColours& colours) {
  // Positions are doubles: a mesh read back has the very volume that was reported for it.
  std::string out =
      "ply\nformat binary_little_endian 1.0\ncomment SPACE=LPS\n"
      "comment dynasurf, patient coordinates (LPS, mm) or those of the scan\n";
  out += "element vertex " + std::to_string(mesh.vertices.size()) + "\n";
  for (const auto* axis : {"x", "y", "z"}) out += std::string("property double ") + axis + "\n";
  for (const auto* axis : {"nx", "ny", "nz"}) out += std::string("property float ") + axis + "\n";
  if (!colours.empty()) out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  for (const VertexScalar& s : scalars) out += "property float " + s.name + "\n";
  out += "element face " + std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\n";
  out += "end_header\n";

  const auto normals = normals_to_write(mesh);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (const double c : mesh.vertices[v]) append(out, c);
    for (const float c : normals[v]) append(out, c);
    if (!colours.empty())
      for (const std::uint8_t c : colours[v]) append(out, c);
    for (const VertexScalar& s : scalars) append(out, s.values[v]);
  }
  for (const auto& t : mesh.triangles) {
    append(out, std::uint8_t{3});
    for (const auto v : t) append(out, static_cast<std::int32_t>(v));
  }
  return out;
}

namespace {

// Files of splats have some 60 properties; every row is read with all of them.
constexpr std::size_t most_elements = 256, most_properties = 1024;

enum class Encoding { ascii, little, big };

struct NumberType {
  char kind;  // i signed, u unsigned, f floating
  std::size_t bytes;
};

struct Property {
  std::string name;
  NumberType type{};                // of the value, or of the entries of the list
  std::optional<NumberType> count;  // of the length, when this is a list
};

struct Element {
  std::string name;
  std::size_t rows = 0, line = 0;
  std::vector<Property> properties;
  std::set<std::string, std::less<>> names;  // of the properties
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::set<std::string, std::less<>> names;  // of the elements
};

NumberType number_type(const TextReader& text, std::string_view word) {
  if (word == "char" || word == "int8") return {'i', 1};
  if (word == "uchar" || word == "uint8") return {'u', 1};
  if (word == "short" || word == "int16") return {'i', 2};
  if (word == "ushort" || word == "uint16") return {'u', 2};
  if (word == "int" || word == "int32") return {'i', 4};
  if (word == "uint" || word == "uint32") return {'u', 4};
  if (word == "float" || word == "float32") return {'f', 4};
  if (word == "double" || word == "float64") return {'f', 8};
  text.fail(quoted(word) + " is no PLY type; expected char to double");
}

Encoding read_format(TextReader& text) {
  const auto encoding = text.word();
  const auto version = text.word();
  if (version != "1.0" || !text.line_is_done()) text.fail("expected PLY version 1.0");
  if (encoding == "ascii") return Encoding::ascii;
  if (encoding == "binary_little_endian") return Encoding::little;
  if (encoding == "binary_big_endian") return Encoding::big;
  text.fail("expected format ascii, binary_little_endian or binary_big_endian");
}

Property read_property(TextReader& text, Element& element) {
  Property property;
  auto word = text.word();
  if (word == "list") {
    property.count = number_type(text, text.word());
    if (property.count->kind == 'f') text.fail("a list's length has a type of integers; expected uchar or alike");
    word = text.word();
  }
  property.type = number_type(text, word);
  property.name = text.word();
  if (property.name.empty() || !text.line_is_done()) text.fail("expected one name at the end of a property");
  if (element.properties.size() == most_properties)
    text.fail("element " + quoted(std::string_view(element.name)) + " has more than " +
              std::to_string(most_properties) + " properties");
  if (!element.names.insert(property.name).second)
    text.fail("property " + quoted(std::string_view(property.name)) + " is there twice");
  return property;
}

Element read_element(TextReader& text, Header& header) {
  Element element;
  element.name = text.word();
  element.rows = text.number<std::uint32_t>("the number of rows");
  element.line = text.line_number();
  if (!text.line_is_done()) text.fail("expected nothing after the number of rows");
  if (header.elements.size() == most_elements)
    text.fail("the header has more than " + std::to_string(most_elements) + " elements");
  if (!header.names.insert(element.name).second)
    text.fail("element " + quoted(std::string_view(element.name)) + " is there twice");
  return element;
}

Header read_header(TextReader& text) {
  Header header;
  if (!text.next_line() || text.word() != "ply" || !text.line_is_done())
    text.fail("expected a PLY file, which begins with a line 'ply'");
  bool has_format = false;
  while (text.next_line()) {
    const auto word = text.word();
    if (word == "comment" || word == "obj_info") continue;
    if (word == "format" && !has_format) {
      header.encoding = read_format(text);
      has_format = true;
    } else if (word == "element") {
      header.elements.push_back(read_element(text, header));
    } else if (word == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(read_property(text, header.elements.back()));
    } else if (word == "end_header" && text.line_is_done() && has_format) {
      return header;
    } else {
      text.fail(quoted(word) + " has no place here; expected format, comment, element, property or end_header");
    }
  }
  text.fail("the header has no end; expected end_header");
}

/// Rows that cannot be in the rest of the file are refused before memory is taken for them.
void check_rows(const MeshFile& file, const TextReader& text, const Header& header) {
  std::size_t needed = 0;
  for (const Element& e : header.elements) {
    if (e.rows > 0 && e.properties.empty())
      refuse(file, "line", e.line, "element " + e.name + " has rows but no property");
    std::size_t row = 0;
    for (const Property& p : e.properties)
      row += header.encoding == Encoding::ascii ? 2 : p.count ? p.count->bytes : p.type.bytes;
    needed += row * e.rows;  // at most 2^32 rows of at most a file's length: no overflow
    if (needed > text.bytes_left())
      refuse(file, "line", e.line,
             std::to_string(e.rows) + " rows of element " + e.name + " need at least " + std::to_string(needed) +
                 " bytes; the file has " + std::to_string(text.bytes_left()) + " after its header");
  }
}

/// The rows of an ascii file: one line each.
class AsciiRows {
 public:
  explicit AsciiRows(TextReader text) : text_(text) {}
  void begin_row() {
    if (!text_.next_line_with_words()) text_.fail("the file ends before its last row");
  }
  double value(NumberType type) {
    if (type.kind == 'f') return text_.number<double>("a value");
    const auto value = text_.number<std::int64_t>("an integer value");
    if (value < INT32_MIN || value > UINT32_MAX) text_.fail(std::to_string(value) + " does not fit its type");
    return value;
  }
  void end_row() {
    if (!text_.line_is_done()) text_.fail("the row has more values than the header declares");
  }
  std::size_t values_left(NumberType) const { return text_.rest().size() / 2 + 1; }
  void end() {
    if (text_.next_line_with_words()) text_.fail("expected nothing after the last row");
  }
  [[noreturn]] void fail(const std::string& reason) const { text_.fail(reason); }

 private:
  TextReader text_;
};

/// The rows of a binary file, one after the other.
class BinaryRows {
 public:
  BinaryRows(const MeshFile& file, std::size_t begin, bool big_endian)
      : file_(file), position_(begin), big_endian_(big_endian) {}
  void begin_row() {}
  double value(NumberType type) {
    last_value_ = position_;
    if (file_.bytes.size() - position_ < type.bytes) fail("the file ends before its last row");
    const char* bytes = file_.bytes.data() + position_;
    position_ += type.bytes;
    if (type.kind == 'f') return type.bytes == 4 ? load<float>(bytes, big_endian_) : load<double>(bytes, big_endian_);
    if (type.kind == 'u')
      return type.bytes == 1   ? load<std::uint8_t>(bytes, big_endian_)
             : type.bytes == 2 ? load<std::uint16_t>(bytes, big_endian_)
                               : load<std::uint32_t>(bytes, big_endian_);
    return type.bytes == 1   ? load<std::int8_t>(bytes, big_endian_)
           : type.bytes == 2 ? load<std::int16_t>(bytes, big_endian_)
                             : load<std::int32_t>(bytes, big_endian_);
  }
  void end_row() {}
  std::size_t values_left(NumberType type) const { return (file_.bytes.size() - position_) / type.bytes; }
  void end() {
    last_value_ = position_;
    if (position_ != file_.bytes.size()) fail("expected nothing after the last row");
  }
  [[noreturn]] void fail(const std::string& reason) const { refuse(file_, "byte", last_value_, reason); }

 private:
  const MeshFile& file_;
  std::size_t position_, last_value_ = 0;
  bool big_endian_;
};

template <class Rows>
std::size_t list_length(Rows& rows, const Property& list) {
  const double length = rows.value(*list.count);
  if (length < 0 || length > rows.values_left(list.type))
    rows.fail("a list of " + std::to_string(static_cast<long long>(length)) + " values; the file has not so many left");
  return static_cast<std::size_t>(length);
}

template <class Rows>
void skip(Rows& rows, const Property& property) {
  const std::size_t count = property.count ? list_length(rows, property) : 1;
  for (std::size_t i = 0; i < count; ++i) rows.value(property.type);
}

/// Where the values of a vertex stand among its properties: position, normal, colour, scan. `absent` where not there.
constexpr std::size_t absent = -1;
using VertexColumns = std::array<std::size_t, 10>;
constexpr std::size_t first_normal = 3, first_colour = 6, scan_column = 9;

/// All values of one vertex in the order of `columns`; those that are absent stay as they are.
template <class Rows>
void read_columns(Rows& rows, const Element& element, const VertexColumns& columns, std::array<double, 10>& values) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const auto column = std::find(columns.begin(), columns.end(), i);
    if (column == columns.end())
      skip(rows, element.properties[i]);
    else
      values[column - columns.begin()] = rows.value(element.properties[i].type);
  }
}

/// Integers fill their type, real numbers run from 0 to 1.
double full_colour(NumberType type) {
  return type.kind == 'f' ? 1 : type.bytes == 1 ? 255 : type.bytes == 2 ? 65535 : 4294967295.0;
}

/// The vertex of a mesh (`data` null) or of a cloud.
template <class Rows>
void read_vertex(Rows& rows, const Element& element, const VertexColumns& columns, TriMesh& mesh, VertexData* data) {
  std::array<double, 10> value{};
  read_columns(rows, element, columns, value);
  const Vec3 p(value[0], value[1], value[2]);
  if (data == nullptr && !p.allFinite()) rows.fail("a coordinate is not a finite number");
  mesh.vertices.push_back(p);
  if (data == nullptr) return;
  if (columns[first_normal] != absent) data->normals.emplace_back(value[3], value[4], value[5]);
  if (columns[first_colour] != absent) {
    auto& colour = data->colours.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const double full = full_colour(element.properties[columns[first_colour + c]].type);
      const double light = value[first_colour + c];
      if (!(light >= 0 && light <= full)) rows.fail("a colour is out of range; integers fill their type, reals 0 to 1");
      colour[c] = colour_byte(light, full);
    }
  }
  if (columns[scan_column] != absent) {
    if (!(value[scan_column] >= 0 && value[scan_column] <= UINT32_MAX))
      rows.fail("the number of a scan is out of range; expected 0 or more");
    data->scans.push_back(static_cast<std::uint32_t>(value[scan_column]));
  }
}

template <class Rows>
void read_face(Rows& rows, const Element& element, std::size_t corner_list, std::size_t vertex_count, TriMesh& mesh,
               MeshRoom& room) {
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const Property& property = element.properties[i];
    if (i != corner_list) {
      skip(rows, property);
      continue;
    }
    corners.resize(list_length(rows, property));
    if (corners.size() < 3) rows.fail("a face of " + std::to_string(corners.size()) + " corners; expected 3 or more");
    for (auto& corner : corners) {
      const double index = rows.value(property.type);
      if (!(index >= 0 && index < vertex_count))
        rows.fail("vertex index " + std::to_string(static_cast<long long>(index)) + " is out of range; the file has " +
                  std::to_string(vertex_count) + " vertices");
      corner = static_cast<std::uint32_t>(index);
    }
  }
  room.before_more(mesh, corners.size());
  add_fan(mesh, corners);
}

const Element* element_named(const Header& header, std::string_view name) {
  for (const Element& e : header.elements)
    if (e.name == name) return &e;
  return nullptr;
}

const Element& needed_element(const MeshFile& file, const Header& header, std::string_view name) {
  if (const Element* e = element_named(header, name)) return *e;
  refuse(file, "", 0, "has no element '" + std::string(name) + "'; expected vertices and faces");
}

/// Position of the one scalar property of one of these names among those of the vertex.
std::size_t column_of(const Element& vertex, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    for (std::size_t i = 0; i < vertex.properties.size(); ++i)
      if (vertex.properties[i].name == name && !vertex.properties[i].count) return i;
  return absent;
}

std::size_t axis_of(const MeshFile& file, const Element& vertex, std::string_view name) {
  const std::size_t column = column_of(vertex, {name});
  if (column == absent) refuse(file, "line", vertex.line, "the vertices have no property " + std::string(name));
  return column;
}

/// Groups of three count only when they are whole.
void add_group(VertexColumns& columns, std::size_t first, std::array<std::size_t, 3> found) {
  if (std::find(found.begin(), found.end(), absent) == found.end())
    std::copy(found.begin(), found.end(), columns.begin() + first);
}

VertexColumns columns_of(const MeshFile& file, const Element& vertex, bool with_data) {
  VertexColumns columns;
  columns.fill(absent);
  columns[0] = axis_of(file, vertex, "x");
  columns[1] = axis_of(file, vertex, "y");
  columns[2] = axis_of(file, vertex, "z");
  if (!with_data) return columns;
  add_group(columns, first_normal,
            {column_of(vertex, {"nx", "normal_x"}), column_of(vertex, {"ny", "normal_y"}),
             column_of(vertex, {"nz", "normal_z"})});
  add_group(columns, first_colour,
            {column_of(vertex, {"red", "diffuse_red", "r"}), column_of(vertex, {"green", "diffuse_green", "g"}),
             column_of(vertex, {"blue", "diffuse_blue", "b"})});
  columns[scan_column] = column_of(vertex, {"scan"});
  return columns;
}

std::size_t corners_of(const MeshFile& file, const Element& face) {
  for (std::size_t i = 0; i < face.properties.size(); ++i) {
    const Property& p = face.properties[i];
    if ((p.name == "vertex_indices" || p.name == "vertex_index") && p.count && p.type.kind != 'f') return i;
  }
  refuse(file, "line", face.line, "the faces have no list of integers called vertex_indices");
}

/// A mesh, or with `data` a cloud, which may have no faces.
template <class Rows>
TriMesh read_rows(const MeshFile& file, const Header& header, Rows rows, VertexData* data) {
  const Element& vertex = needed_element(file, header, "vertex");
  const Element* face = data == nullptr ? &needed_element(file, header, "face") : element_named(header, "face");
  const VertexColumns columns = columns_of(file, vertex, data != nullptr);
  const std::size_t corner_list = face != nullptr && (data == nullptr || face->rows > 0) ? corners_of(file, *face) : 0;
  require_memory_of(file, vertex.rows, face != nullptr ? face->rows : 0, data != nullptr);
  TriMesh mesh;
  mesh.vertices.reserve(vertex.rows);
  if (face != nullptr) mesh.triangles.reserve(face->rows);
  MeshRoom room(file, data != nullptr);
  for (const Element& element : header.elements)
    for (std::size_t row = 0; row < element.rows; ++row) {
      rows.begin_row();
      if (&element == &vertex)
        read_vertex(rows, element, columns, mesh, data);
      else if (&element == face)
        read_face(rows, element, corner_list, vertex.rows, mesh, room);
      else
        for (const Property& property : element.properties) skip(rows, property);
      rows.end_row();
    }
  rows.end();
  return mesh;
}

TriMesh decode(const MeshFile& file, VertexData* data) {
  TextReader text(file);
  const Header header = read_header(text);
  check_rows(file, text, header);
  if (header.encoding == Encoding::ascii) return read_rows(file, header, AsciiRows(text), data);
  return read_rows(file, header, BinaryRows(file, text.position(), header.encoding == Encoding::big), data);
}

}  // namespace

TriMesh decode_ply(const MeshFile& file) { return decode(file, nullptr); }
TriMesh decode_ply(const MeshFile& file, VertexData& data) { return decode(file, &data); }

}  // namespace dynasurf::io::detail
