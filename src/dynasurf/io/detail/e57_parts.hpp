#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/grid.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"

// The parts of an E57 file (ASTM E2807): pages with checksums; in them an XML text that tells of the scans, and a
// section of packets with the points of each.
namespace dynasurf::io::detail::e57 {

/// The content of the file: its pages of 1024 bytes without the checksum in which each ends. Places in the content are
/// called logical by the format, places in the file physical.
class Pages {
 public:
  /// Throws InputError unless the file has the header of an E57 file of its length. Keeps a reference to it.
  explicit Pages(const MeshFile& file);

  const MeshFile& file() const { return file_; }
  std::size_t size() const;  // of the content
  /// Where the place of the file stands in the content. Throws InputError, at the place `told_at` of the content that
  /// tells it, when it is in no page's content.
  std::size_t content_at(std::uint64_t place, std::size_t told_at) const;
  /// Copies from the content. Precondition: it is there. Throws InputError when the checksum of a page is wrong.
  void read(std::size_t at, std::span<char> to);

  template <class T>
  T number(std::size_t at) {
    T value{};
    read(at, {reinterpret_cast<char*>(&value), sizeof value});
    return value;
  }

  /// Refuses the file at a place of the content.
  [[noreturn]] void fail(std::size_t at, const std::string& reason) const;

 private:
  const MeshFile& file_;
  std::vector<bool> is_checked_;
};

/// What a column of points holds. Three of a kind follow each other.
enum class Role : std::uint8_t {
  x,
  y,
  z,
  range,
  azimuth,
  elevation,
  normal_x,
  normal_y,
  normal_z,
  red,
  green,
  blue,  // as in `role_names`
  no_point,
  no_range,
  no_colour,
  other
};

/// A column of a scan's points. Each of its values has so many bits, which follow each other without a gap.
struct Column {
  enum class Kind : std::uint8_t { single, real, integer, text };
  Role role = Role::other;
  Kind kind = Kind::real;
  unsigned bits = 64;      // 0: all values are `least`
  std::int64_t least = 0;  // of an integer, and
  std::uint64_t span = 0;  // how much larger it is at most
  double scale = 1, offset = 0;
};

/// A scan as the XML text tells it.
struct Scan {
  std::size_t told_at = 0;    // in the content
  std::uint64_t section = 0;  // in the file
  std::size_t records = 0;
  std::vector<Column> columns;
  std::array<std::array<double, 2>, 3> colour_limits{};
  Mat3 rotation = Mat3::Identity();  // to the frame of the file
  Vec3 translation = Vec3::Zero();
  bool has_pose = false;

  bool has(Role first) const;  // and the two after it
};

/// The scans with points, at most `most_cloud_points` each. Throws InputError.
std::vector<Scan> read_scans(Pages& pages);

}  // namespace dynasurf::io::detail::e57
