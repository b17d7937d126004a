#include "dynasurf/io/detail/las.hpp"

#include <algorithm>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"

// LAS 1.0 to 1.4 (ASPRS): a header, records of other kinds that are skipped, and points of equal length.

namespace dynasurf::io::detail {
namespace {

constexpr std::size_t shortest_header = 227, header_14 = 375, none = LasFormat::none;
/// Formats 4, 5, 9 and 10 add waveforms, which are left out.
constexpr LasFormat formats[] = {{20, none, none, false}, {28, 20, none, false}, {26, none, 20, false},
                                 {34, 20, 28, false},     {57, 20, none, true},  {63, 20, 28, true},
                                 {30, 22, none, false},   {36, 22, 30, false},   {38, 22, 30, false},
                                 {59, 22, none, true},    {67, 22, 30, true}};

template <class T>
T at(const MeshFile& file, std::size_t place) {
  if (file.bytes.size() < place + sizeof(T)) refuse(file, "byte", file.bytes.size(), "the file ends in its header");
  return load<T>(file.bytes.data() + place);
}

LasHeader read_header(const MeshFile& file) {
  if (!file.bytes.starts_with("LASF")) refuse(file, "byte", 0, "expected a LAS file, which begins with 'LASF'");
  const auto major = at<std::uint8_t>(file, 24), minor = at<std::uint8_t>(file, 25);
  if (major != 1 || minor > 4)
    refuse(file, "byte", 24,
           "LAS version " + std::to_string(major) + "." + std::to_string(minor) + "; expected 1.0 to 1.4");
  LasHeader header{};
  header.header_bytes = at<std::uint16_t>(file, 94);
  header.begin = at<std::uint32_t>(file, 96);
  header.extra_headers = at<std::uint32_t>(file, 100);
  const unsigned kind = at<std::uint8_t>(file, 104) & 0x3fu;
  header.compressed = kind != at<std::uint8_t>(file, 104);
  if (kind >= std::size(formats))
    refuse(file, "byte", 104, "point format " + std::to_string(kind) + "; expected 0 to 10");
  header.format = formats[kind];
  header.extended = kind >= 6;
  header.is_infrared = kind == 8 || kind == 10;
  header.record = at<std::uint16_t>(file, 105);
  header.points = at<std::uint32_t>(file, 107);
  for (int axis = 0; axis < 3; ++axis) {
    const auto place = static_cast<std::size_t>(axis) * 8;
    header.scale[axis] = at<double>(file, 131 + place);
    header.offset[axis] = at<double>(file, 155 + place);
  }
  if (!header.scale.allFinite() || !header.offset.allFinite())
    refuse(file, "byte", 131, "scale or offset is not a finite number");
  if (minor == 4) {
    if (header.header_bytes < header_14)
      refuse(file, "byte", 94, "a header too short for LAS 1.4; expected 375 bytes or more");
    const auto points = at<std::uint64_t>(file, 247);
    if (header.points != 0 && points != header.points) refuse(file, "byte", 247, "the two counts of points differ");
    header.points = points;
  }
  if (header.header_bytes < shortest_header || header.begin < header.header_bytes)
    refuse(file, "byte", 94, "header and points overlap; expected points after a header of 227 bytes or more");
  if (header.record < header.format.bytes)
    refuse(file, "byte", 105,
           "points of " + std::to_string(header.record) + " bytes; format " + std::to_string(kind) + " needs " +
               std::to_string(header.format.bytes));
  const std::size_t left = file.bytes.size() - std::min(file.bytes.size(), header.begin);
  if (!header.compressed && header.points > left / header.record)
    refuse(file, "byte", 107,
           std::to_string(header.points) + " points of " + std::to_string(header.record) +
               " bytes are declared; the file has " + std::to_string(left) + " bytes for them");
  return header;
}

/// Points that the format says not to use: withheld, or classified as low or high noise.
bool is_left_out(const char* point, bool extended) {
  const auto byte = [&](std::size_t place) { return static_cast<unsigned char>(point[place]); };
  const unsigned kind = extended ? byte(16) : byte(15) & 31u;
  const bool withheld = extended ? (byte(15) & 4u) != 0 : (byte(15) & 128u) != 0;
  return withheld || kind == 7 || (extended && kind == 18);
}

}  // namespace

TriMesh decode_las(const MeshFile& file, VertexData& data) {
  LasHeader header = read_header(file);
  require_memory_of(file, header.points, 0, true);
  std::string unpacked;
  const char* first = file.bytes.data() + header.begin;
  if (header.compressed) {
    unpacked = unpack_laz(file, header);
    header.record = header.format.bytes;
    first = unpacked.data();
  }
  TriMesh mesh;
  mesh.vertices.reserve(header.points);
  std::vector<std::array<std::uint16_t, 3>> colours;
  std::uint16_t brightest = 0;
  std::size_t left_out = 0;
  for (std::size_t n = 0; n < header.points; ++n) {
    const char* point = first + n * header.record;
    if (is_left_out(point, header.extended)) {
      ++left_out;
      continue;
    }
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = load<std::int32_t>(point + 4 * axis);
    mesh.vertices.push_back(p.cwiseProduct(header.scale) + header.offset);
    data.scans.push_back(load<std::uint16_t>(point + (header.extended ? 20 : 18)));
    if (header.format.colour == none) continue;
    auto& colour = colours.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      colour[c] = load<std::uint16_t>(point + header.format.colour + 2 * c);
      brightest = std::max(brightest, colour[c]);
    }
  }
  // The format asks for 16 bits; many programs write 8.
  const double full = brightest > 255 ? 65535 : 255;
  if (brightest > 0)
    for (const auto& c : colours)
      data.colours.push_back({colour_byte(c[0], full), colour_byte(c[1], full), colour_byte(c[2], full)});
  if (left_out > 0) data.remark = std::to_string(left_out) + " points are marked as withheld or noise and left out";
  return mesh;
}

}  // namespace dynasurf::io::detail
