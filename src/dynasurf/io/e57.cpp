#include <algorithm>
#include <bit>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/e57_parts.hpp"

// The points of an E57 file: packets with a piece of each column.

namespace dynasurf::io::detail {
namespace {

using namespace e57;

/// Where the packets of a scan stand in the content.
struct Section {
  std::size_t begin, end;
};

/// What is wrong with a point, as bits.
enum Flaw : std::uint8_t { is_no_point = 1, is_colourless = 2, is_beyond_limits = 4 };

Section find_section(Pages& pages, const Scan& scan) {
  constexpr std::size_t header_bytes = 32;
  const std::size_t at = pages.content_at(scan.section, scan.told_at), left = pages.size() - at;
  if (left < header_bytes || pages.number<std::uint8_t>(at) != 1) pages.fail(at, "expected a section with points here");
  const auto length = pages.number<std::uint64_t>(at + 8);
  if (length < header_bytes || length > left)
    pages.fail(at + 8, "a section of " + std::to_string(length) + " bytes; expected 32 to " + std::to_string(left));
  const std::size_t begin = pages.content_at(pages.number<std::uint64_t>(at + 16), at + 16);
  if (begin < at + header_bytes || begin > at + length)
    pages.fail(at + 16, "the points do not stand within their section");
  std::uint64_t bits = 0;
  for (const Column& column : scan.columns) bits += column.bits;
  // Columns that do not vary take no bits, and could tell of any number of points.
  if (scan.records > 8 * (length - header_bytes) / std::max(bits, std::uint64_t{1}))
    pages.fail(scan.told_at, std::to_string(scan.records) + " points are declared; the file has " +
                                 std::to_string(length - header_bytes) + " bytes for them");
  return {begin, at + static_cast<std::size_t>(length)};
}

/// least + above, which is no larger than the largest integer.
std::int64_t sum(std::int64_t least, std::uint64_t above) {
  if (least >= 0) return least + static_cast<std::int64_t>(above);
  const std::uint64_t below = static_cast<std::uint64_t>(-(least + 1));  // of -1
  return above > below ? static_cast<std::int64_t>(above - below - 1) : -static_cast<std::int64_t>(below - above) - 1;
}

double value_of(const Column& column, std::uint64_t bits) {
  if (column.kind == Column::Kind::single) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  if (column.kind == Column::Kind::real) return std::bit_cast<double>(bits);
  return static_cast<double>(sum(column.least, bits)) * column.scale + column.offset;
}

/// So many bits, the lowest first. Precondition: nine bytes are there from that of the first bit on.
std::uint64_t bits_at(const char* bytes, std::size_t bit, unsigned count) {
  const char* from = bytes + bit / 8;
  const unsigned skipped = bit % 8;
  std::uint64_t value = load<std::uint64_t>(from) >> skipped;
  if (skipped + count > 64) {
    const unsigned more = static_cast<unsigned char>(from[8]) & ((1u << (skipped + count - 64)) - 1);
    value |= std::uint64_t{more} << (64 - skipped);
  }
  return count == 64 ? value : value & ((std::uint64_t{1} << count) - 1);
}

/// What is known of a column while packets are read.
struct Stream {
  std::size_t done = 0;    // values
  std::string rest;        // bytes of the next values
  unsigned used_bits = 0;  // of the first
};

/// Reads the points of a scan to the end of a cloud.
class ScanReader {
 public:
  ScanReader(Pages& pages, const Scan& scan, TriMesh& mesh, VertexData& data)
      : pages_(pages),
        scan_(scan),
        mesh_(mesh),
        data_(data),
        first_(mesh.vertices.size()),
        flaws_(scan.records, 0),
        streams_(scan.columns.size()),
        is_spherical_(!scan.has(Role::x)) {
    const std::size_t all = first_ + scan.records;
    mesh.vertices.resize(all);
    if (scan.has(Role::normal_x)) data.normals.resize(all);
    if (scan.has(Role::red)) data.colours.resize(all);
  }

  void read(const Section& section) {
    for (std::size_t c = 0; c < streams_.size(); ++c)
      if (scan_.columns[c].bits == 0 && scan_.columns[c].role != Role::other)
        for (std::size_t& n = streams_[c].done; n < scan_.records; ++n) put(scan_.columns[c], n, 0);
    std::size_t at = section.begin;
    while (!is_done()) {
      if (section.end - at < 4)
        pages_.fail(at, "the section ends before the last of the scan's " + std::to_string(scan_.records) + " points");
      const auto kind = pages_.number<std::uint8_t>(at);
      const std::size_t length = pages_.number<std::uint16_t>(at + 2) + std::size_t{1};
      if (kind > 2) pages_.fail(at, "a packet of kind " + std::to_string(kind) + "; expected 0, 1 or 2");
      if (length % 4 != 0 || length > section.end - at)
        pages_.fail(at + 2, "a packet of " + std::to_string(length) + " bytes; expected a multiple of 4 to " +
                                std::to_string(section.end - at));
      if (kind == 1) read_packet(at, length);  // the others are an index and empty space
      at += length;
    }
  }

  /// Leaves out what is no point and brings the others to the frame of the file; how many are left out.
  std::size_t finish(std::uint32_t number, bool& is_coloured) {
    std::size_t to = first_;
    for (std::size_t n = 0; n < scan_.records; ++n) {
      if ((flaws_[n] & is_no_point) != 0) continue;
      if ((flaws_[n] & is_colourless) != 0)
        is_coloured = false;
      else if ((flaws_[n] & is_beyond_limits) != 0)
        pages_.fail(scan_.told_at, "a colour of point " + std::to_string(n + 1) + " is out of its limits");
      const std::size_t from = first_ + n;
      mesh_.vertices[to] = turned(cartesian(mesh_.vertices[from])) + scan_.translation;
      if (!data_.normals.empty()) data_.normals[to] = turned(data_.normals[from]);
      if (!data_.colours.empty()) data_.colours[to] = data_.colours[from];
      ++to;
    }
    mesh_.vertices.resize(to);
    if (!data_.normals.empty()) data_.normals.resize(to);
    if (!data_.colours.empty()) data_.colours.resize(to);
    data_.scans.resize(to, number);
    return first_ + scan_.records - to;
  }

 private:
  bool is_done() const {
    for (std::size_t c = 0; c < streams_.size(); ++c)
      if (scan_.columns[c].role != Role::other && streams_[c].done < scan_.records) return false;
    return true;
  }

  void read_packet(std::size_t at, std::size_t length) {
    packet_.resize(length);
    pages_.read(at, packet_);
    const std::size_t head = 6 + 2 * streams_.size();
    if (length < head || load<std::uint16_t>(packet_.data() + 4) != streams_.size())
      pages_.fail(at + 4, "a packet does not have the scan's " + std::to_string(streams_.size()) + " columns");
    std::size_t begin = head;
    for (std::size_t c = 0; c < streams_.size(); ++c) {
      const std::size_t bytes = load<std::uint16_t>(packet_.data() + 6 + 2 * c);
      if (bytes > length - begin) pages_.fail(at + 6 + 2 * c, "the columns of a packet are longer than it");
      if (scan_.columns[c].role != Role::other) feed(c, std::string_view(packet_).substr(begin, bytes), at + begin);
      begin += bytes;
    }
  }

  /// Takes the next bytes of a column, at a place of the content.
  void feed(std::size_t c, std::string_view bytes, std::size_t at) {
    const Column& column = scan_.columns[c];
    Stream& stream = streams_[c];
    stream.rest += bytes;
    const std::size_t end = 8 * stream.rest.size();
    stream.rest.append(9, '\0');  // for bits_at
    std::size_t bit = stream.used_bits;
    for (; stream.done < scan_.records && end - bit >= column.bits; bit += column.bits) {
      const std::uint64_t value = bits_at(stream.rest.data(), bit, column.bits);
      if (value > column.span) pages_.fail(at, "a value is above the maximum of its column");
      put(column, stream.done++, value);
    }
    // Some programs fill up the last word.
    if (stream.done == scan_.records && end - bit >= 64)
      pages_.fail(at, "a column goes on after the scan's " + std::to_string(scan_.records) + " points");
    stream.rest.resize(end / 8);
    stream.rest.erase(0, bit / 8);
    stream.used_bits = bit % 8;
  }

  void put(const Column& column, std::size_t n, std::uint64_t bits) {
    const double value = value_of(column, bits);
    const auto role = static_cast<unsigned>(column.role);
    switch (column.role) {
      case Role::x:
      case Role::y:
      case Role::z:
      case Role::range:
      case Role::azimuth:
      case Role::elevation:
        mesh_.vertices[first_ + n][role % 3] = value;
        break;
      case Role::normal_x:
      case Role::normal_y:
      case Role::normal_z:
        data_.normals[first_ + n][role % 3] = value;
        break;
      case Role::red:
      case Role::green:
      case Role::blue: {
        const auto& [low, high] = scan_.colour_limits[role % 3];
        if (!(value >= low && value <= high))
          flaws_[n] |= is_beyond_limits;
        else if (high > low)
          data_.colours[first_ + n][role % 3] = colour_byte(value - low, high - low);
        break;
      }
      case Role::no_point:
      case Role::no_range:
        if (value != 0) flaws_[n] |= is_no_point;
        break;
      case Role::no_colour:
        if (value != 0) flaws_[n] |= is_colourless;
        break;
      case Role::other:
        break;
    }
  }

  Vec3 cartesian(const Vec3& p) const {
    if (!is_spherical_) return p;
    const double flat = p[0] * own::cos(p[2]);
    return {flat * own::cos(p[1]), flat * own::sin(p[1]), p[0] * own::sin(p[2])};
  }
  Vec3 turned(const Vec3& p) const {
    Vec3 q;
    for (int r = 0; r < 3; ++r)
      q[r] = scan_.rotation(r, 0) * p[0] + scan_.rotation(r, 1) * p[1] + scan_.rotation(r, 2) * p[2];
    return q;
  }

  Pages& pages_;
  const Scan& scan_;
  TriMesh& mesh_;
  VertexData& data_;
  std::size_t first_;
  std::vector<std::uint8_t> flaws_;
  std::vector<Stream> streams_;
  bool is_spherical_;
  std::string packet_;
};

/// Columns that are not to be read: angles beside coordinates, and what not all scans have.
void drop_columns(std::vector<Scan>& scans) {
  const auto all_have = [&](Role role) {
    return std::all_of(scans.begin(), scans.end(), [&](const Scan& scan) { return scan.has(role); });
  };
  const bool normals = all_have(Role::normal_x), colours = all_have(Role::red);
  for (Scan& scan : scans) {
    const bool is_cartesian = scan.has(Role::x);
    for (Column& column : scan.columns) {
      const Role role = column.role;
      const bool is_angle = (role >= Role::range && role <= Role::elevation) || role == Role::no_range;
      const bool is_axis = role <= Role::z || role == Role::no_point;
      const bool is_normal = role >= Role::normal_x && role <= Role::normal_z;
      const bool is_colour = (role >= Role::red && role <= Role::blue) || role == Role::no_colour;
      if ((is_cartesian ? is_angle : is_axis) || (is_normal && !normals) || (is_colour && !colours))
        column.role = Role::other;
    }
  }
}

/// Where the scans were taken from. Angles are those of the scanner, and so is the frame of a pose; but points that
/// are those of no scanner are written with a pose that moves nothing.
std::vector<Vec3> scanners_of(const std::vector<Scan>& scans) {
  std::vector<Vec3> scanners;
  bool is_told = false;
  for (const Scan& scan : scans) {
    const bool has_angles = !scan.has(Role::x);
    if (!scan.has_pose && !has_angles) return {};
    is_told = is_told || has_angles || scan.translation != Vec3::Zero();
    scanners.push_back(scan.translation);
  }
  return is_told ? scanners : std::vector<Vec3>{};
}

}  // namespace

TriMesh decode_e57(const MeshFile& file, VertexData& data) {
  Pages pages(file);
  std::vector<Scan> scans = read_scans(pages);
  drop_columns(scans);
  std::vector<Section> sections;
  std::uint64_t points = 0, bytes = 0;
  for (const Scan& scan : scans) {
    const Section& section = sections.emplace_back(find_section(pages, scan));
    points += scan.records;
    bytes += section.end - section.begin;
    if (bytes > pages.size()) pages.fail(scan.told_at, "the sections of the scans overlap");
    if (points > most_cloud_points)
      pages.fail(scan.told_at, "holds " + std::to_string(points) + " points; expected at most 100000000");
  }
  require_memory_of(file, static_cast<std::size_t>(points), 0, true);
  TriMesh mesh;
  mesh.vertices.reserve(static_cast<std::size_t>(points));
  std::size_t left_out = 0;
  bool is_coloured = true;
  for (std::uint32_t n = 0; n < scans.size(); ++n) {
    ScanReader reader(pages, scans[n], mesh, data);
    reader.read(sections[n]);
    left_out += reader.finish(n, is_coloured);
  }
  if (left_out > 0) data.remark = std::to_string(left_out) + " points are marked as invalid and left out";
  data.scanners = scanners_of(scans);
  if (!is_coloured) {
    data.colours.clear();
    data.remark += std::string(left_out > 0 ? "; " : "") + "not every point has a colour, so none is kept";
  }
  return mesh;
}

}  // namespace dynasurf::io::detail
