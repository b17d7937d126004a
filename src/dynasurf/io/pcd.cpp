#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/detail/text_cells.hpp"

// PCD 0.5 to 0.7, the format of the Point Cloud Library: a header of lines, then points as text, as records, or as
// columns that LZF has compressed.

namespace dynasurf::io::detail {
namespace {

constexpr std::size_t most_fields = 256;

struct Field {
  std::string name;
  std::size_t bytes = 0, count = 1;
  char type = 'F';
  std::size_t begin = 0;  // of its first value, in bytes of a record
  std::size_t cell = 0;   // of its first value, in cells of a line
};

struct Header {
  std::vector<Field> fields;
  std::size_t points = 0, record = 0, cells = 0;
  std::optional<Vec3> viewpoint;
  std::string data;
};

/// A line of the header with as many words as there are fields.
std::vector<std::string> words_of(TextReader& text, std::size_t expected) {
  std::vector<std::string> words;
  for (auto word = text.word(); !word.empty() && words.size() <= most_fields; word = text.word())
    words.emplace_back(word);
  if (words.empty() || words.size() > most_fields || (expected > 0 && words.size() != expected))
    text.fail("expected " + (expected > 0 ? std::to_string(expected) : std::string("1 to 256")) + " words");
  return words;
}

void lay_out(const TextReader& text, Header& header) {
  for (Field& f : header.fields) {
    const bool is_known = f.type == 'F' ? f.bytes == 4 || f.bytes == 8
                                        : (f.type == 'I' || f.type == 'U') &&
                                              (f.bytes == 1 || f.bytes == 2 || f.bytes == 4 || f.bytes == 8);
    if (!is_known || f.count == 0 || f.count > 65536)
      text.fail("field " + f.name + " is of no known type, size or count; expected I, U or F of 1 to 8 bytes");
    f.begin = header.record;
    f.cell = header.cells;
    header.record += f.bytes * f.count;
    header.cells += f.count;
  }
}

/// Where the scanner stood; nothing where the line is the one that tells nothing.
std::optional<Vec3> read_viewpoint(TextReader& text) {
  std::array<double, 7> pose{};
  for (double& n : pose) n = text.coordinate("the viewpoint");
  if (pose == std::array<double, 7>{0, 0, 0, 1, 0, 0, 0}) return std::nullopt;
  return Vec3(pose[0], pose[1], pose[2]);
}

Header read_header(TextReader& text) {
  Header header;
  std::size_t width = 0, height = 1;
  std::optional<std::size_t> points;
  while (text.next_line_with_words('#')) {
    const std::string word(text.word());
    const std::size_t fields = header.fields.size();
    if (word == "FIELDS" || word == "COLUMNS") {
      for (std::string& name : words_of(text, 0)) header.fields.push_back({.name = std::move(name)});
    } else if (word == "SIZE" || word == "COUNT" || word == "TYPE") {
      if (fields == 0) text.fail(word + " stands before FIELDS");
      const std::vector<std::string> words = words_of(text, fields);
      for (std::size_t n = 0; n < fields; ++n) {
        Field& field = header.fields[n];
        if (word == "TYPE")
          field.type = words[n].size() == 1 ? words[n][0] : '?';
        else
          (word == "SIZE" ? field.bytes : field.count) = text.number_of<std::uint32_t>(words[n], "a size or count");
      }
    } else if (word == "WIDTH") {
      width = text.number<std::uint32_t>("the width");
    } else if (word == "HEIGHT") {
      height = text.number<std::uint32_t>("the height");
    } else if (word == "POINTS") {
      points = text.number<std::uint32_t>("the number of points");
    } else if (word == "DATA") {
      header.data = text.word();
      break;
    } else if (word == "VIEWPOINT") {
      header.viewpoint = read_viewpoint(text);
    } else if (word != "VERSION") {
      text.fail("'" + word + "' has no place in the header of a PCD file");
    }
  }
  if (header.data.empty() || header.fields.empty()) text.fail("expected a PCD header with FIELDS and DATA");
  header.points = points.value_or(width * height);
  if (width * height != header.points) text.fail("WIDTH times HEIGHT is not POINTS");
  lay_out(text, header);
  return header;
}

double value_of(const char* at, const Field& f) {
  switch (f.type) {
    case 'F':
      return f.bytes == 4 ? load<float>(at) : load<double>(at);
    case 'U':
      return f.bytes == 1   ? load<std::uint8_t>(at)
             : f.bytes == 2 ? load<std::uint16_t>(at)
             : f.bytes == 4 ? load<std::uint32_t>(at)
                            : load<std::uint64_t>(at);
    default:
      return f.bytes == 1   ? load<std::int8_t>(at)
             : f.bytes == 2 ? load<std::int16_t>(at)
             : f.bytes == 4 ? load<std::int32_t>(at)
                            : load<std::int64_t>(at);
  }
}

/// Which fields hold what; null where there is none.
struct Roles {
  std::array<const Field*, 3> position{}, normal{};
  const Field* colour = nullptr;
};

Roles roles_of(const TextReader& text, const Header& header) {
  Roles roles;
  const std::array<std::array<const char*, 2>, 3> normals{{{"normal_x", "nx"}, {"normal_y", "ny"}, {"normal_z", "nz"}}};
  const std::array<const char*, 3> axes{"x", "y", "z"};
  for (const Field& f : header.fields) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (f.name == axes[a]) roles.position[a] = &f;
      if (f.name == normals[a][0] || f.name == normals[a][1]) roles.normal[a] = &f;
    }
    if ((f.name == "rgb" || f.name == "rgba") && f.bytes == 4) roles.colour = &f;
  }
  for (const Field* f : roles.position)
    if (f == nullptr) text.fail("FIELDS names no x, y and z");
  if (!roles.normal[0] || !roles.normal[1] || !roles.normal[2]) roles.normal = {};
  return roles;
}

/// 0x00RRGGBB, by itself or as the bits of a float.
void add_colour(std::uint32_t packed, VertexData& data) {
  data.colours.push_back({static_cast<std::uint8_t>(packed >> 16), static_cast<std::uint8_t>(packed >> 8),
                          static_cast<std::uint8_t>(packed)});
}

void read_lines(TextReader& text, const Header& header, const Roles& roles, TriMesh& mesh, VertexData& data) {
  while (text.next_line_with_words('#')) {
    const std::vector<std::string_view> cells = cells_of(text.rest(), ' ');
    if (cells.size() != header.cells)
      text.fail("a row of " + std::to_string(cells.size()) + " values; expected " + std::to_string(header.cells));
    const auto number = [&](const Field* f) { return text.number_of<double>(cells[f->cell], "a value"); };
    mesh.vertices.emplace_back(number(roles.position[0]), number(roles.position[1]), number(roles.position[2]));
    if (roles.normal[0])
      data.normals.emplace_back(number(roles.normal[0]), number(roles.normal[1]), number(roles.normal[2]));
    if (!roles.colour) continue;
    const std::string_view cell = cells[roles.colour->cell];
    std::uint32_t packed = 0;
    if (roles.colour->type == 'F') {
      const auto bits = text.number_of<float>(cell, "a colour");
      std::memcpy(&packed, &bits, sizeof packed);
    } else {
      packed = text.number_of<std::uint32_t>(cell, "a colour");
    }
    add_colour(packed, data);
  }
  if (mesh.vertices.size() != header.points)
    text.fail(std::to_string(mesh.vertices.size()) + " points; " + std::to_string(header.points) + " were declared");
}

/// Value n of a field: of records that follow each other, or with `columns` of fields that do.
void read_values(const char* bytes, bool columns, const Header& header, const Roles& roles, TriMesh& mesh,
                 VertexData& data) {
  const auto place = [&](const Field* f, std::size_t n) {
    return columns ? bytes + f->begin * header.points + n * f->bytes * f->count : bytes + n * header.record + f->begin;
  };
  for (std::size_t n = 0; n < header.points; ++n) {
    const auto vector = [&](const std::array<const Field*, 3>& group) {
      return Vec3(value_of(place(group[0], n), *group[0]), value_of(place(group[1], n), *group[1]),
                  value_of(place(group[2], n), *group[2]));
    };
    mesh.vertices.push_back(vector(roles.position));
    if (roles.normal[0]) data.normals.push_back(vector(roles.normal));
    if (roles.colour) add_colour(load<std::uint32_t>(place(roles.colour, n)), data);
  }
}

/// LZF (Lehmann): runs of literals, and copies of what stands up to 8 KiB before. Throws unless `size` bytes come out.
std::string decompressed(const MeshFile& file, std::size_t begin, std::string_view packed, std::size_t size) {
  std::string out;
  out.reserve(size);
  const auto broken = [&](std::size_t at) { refuse(file, "byte", begin + at, "the compressed points are broken"); };
  for (std::size_t at = 0; at < packed.size();) {
    const auto byte = [&](std::size_t n) {
      if (n >= packed.size()) broken(n);
      return static_cast<std::size_t>(static_cast<unsigned char>(packed[n]));
    };
    const std::size_t control = byte(at++);
    if (control < 32) {
      const std::size_t count = control + 1;
      if (count > packed.size() - at || count > size - out.size()) broken(at);
      out.append(packed.substr(at, count));
      at += count;
      continue;
    }
    std::size_t count = control >> 5;
    if (count == 7) count += byte(at++);
    count += 2;
    const std::size_t back = ((control & 31) << 8) + byte(at++) + 1;
    if (back > out.size() || count > size - out.size()) broken(at);
    // Byte by byte: a copy may reach into what it writes, and repeats it then.
    for (std::size_t n = 0; n < count; ++n) out.push_back(out[out.size() - back]);
  }
  if (out.size() != size) broken(packed.size());
  return out;
}

}  // namespace

TriMesh decode_pcd(const MeshFile& file, VertexData& data) {
  TextReader text(file);
  const Header header = read_header(text);
  const Roles roles = roles_of(text, header);
  const std::size_t begin = text.position(), left = text.bytes_left();
  // The least a point takes in the file; compressed ones at most about 1 : 88.
  const std::size_t least = header.data == "ascii" ? 2 * header.cells : header.record;
  if (header.points > (header.data == "binary_compressed" ? 100 * left : left) / least)
    text.fail(std::to_string(header.points) + " points are declared; the file has " + std::to_string(left) +
              " bytes for them");
  require_memory_of(file, header.points, 0, true);
  if (header.viewpoint) data.scanners = {*header.viewpoint};
  TriMesh mesh;
  mesh.vertices.reserve(header.points);
  if (header.data == "ascii") {
    read_lines(text, header, roles, mesh, data);
  } else if (header.data == "binary") {
    read_values(file.bytes.data() + begin, false, header, roles, mesh, data);
  } else if (header.data == "binary_compressed") {
    if (left < 8) refuse(file, "byte", begin, "the file ends before its points");
    const std::size_t packed = load<std::uint32_t>(file.bytes.data() + begin),
                      whole = load<std::uint32_t>(file.bytes.data() + begin + 4);
    if (packed > left - 8 || whole != header.points * header.record)
      refuse(file, "byte", begin, "the sizes of the compressed points do not fit the file and its header");
    const std::string bytes = decompressed(file, begin + 8, file.bytes.substr(begin + 8, packed), whole);
    read_values(bytes.data(), true, header, roles, mesh, data);
  } else {
    text.fail("DATA is '" + header.data + "'; expected ascii, binary or binary_compressed");
  }
  return mesh;
}

}  // namespace dynasurf::io::detail
