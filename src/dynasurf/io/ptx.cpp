#include <array>

#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/detail/text_cells.hpp"

// PTX (Leica): scans one after the other, each a grid of points in the scanner's frame with the way to a common one.

namespace dynasurf::io::detail {
namespace {

/// The transformation of a scan: p becomes the row vector (p, 1) times this.
struct Pose {
  std::array<std::array<double, 4>, 4> rows;

  Vec3 apply(const Vec3& p) const {
    Vec3 q;
    for (std::size_t c = 0; c < 3; ++c) q[c] = p[0] * rows[0][c] + p[1] * rows[1][c] + p[2] * rows[2][c] + rows[3][c];
    return q;
  }
};

template <std::size_t count>
std::array<double, count> numbers_of_line(TextReader& text, const char* what) {
  if (!text.next_line_with_words()) text.fail(std::string("the file ends before ") + what);
  std::array<double, count> numbers{};
  for (double& n : numbers) n = text.coordinate(what);
  if (!text.line_is_done()) text.fail("expected " + std::to_string(count) + " numbers of " + what);
  return numbers;
}

/// The number of points of the next scan, after its pose and the scanner's place.
std::size_t read_head(TextReader& text, Pose& pose, Vec3& scanner) {
  const auto columns = text.number<std::uint32_t>("the columns of a scan");
  if (!text.line_is_done() || !text.next_line_with_words()) text.fail("expected the number of columns alone");
  const auto rows = text.number<std::uint32_t>("the rows of a scan");
  if (!text.line_is_done()) text.fail("expected the number of rows alone");
  for (int n = 0; n < 4; ++n)
    if (const auto line = numbers_of_line<3>(text, "the scanner's place and axes"); n == 0)
      scanner = {line[0], line[1], line[2]};
  for (auto& row : pose.rows) row = numbers_of_line<4>(text, "the transformation");
  // Some programs leave the place to the transformation alone.
  if (scanner == Vec3::Zero()) scanner = pose.apply(scanner);
  return static_cast<std::size_t>(columns) * rows;
}

}  // namespace

TriMesh decode_ptx(const MeshFile& file, VertexData& data) {
  require_memory_of(file, count_lines(file.bytes), 0, true);
  TextReader text(file);
  TriMesh mesh;
  std::size_t unseen = 0;
  bool is_coloured = true;
  for (std::uint32_t scan = 0; text.next_line_with_words(); ++scan) {
    Pose pose;
    const std::size_t points = read_head(text, pose, data.scanners.emplace_back());
    for (std::size_t n = 0; n < points; ++n) {
      if (!text.next_line_with_words())
        text.fail("the file ends after " + std::to_string(n) + " of the scan's " + std::to_string(points) + " points");
      Vec3 p;
      for (double& c : p) c = text.number<double>("a coordinate");
      text.number<double>("an intensity");
      if (p == Vec3::Zero()) {  // what the scanner writes where it saw nothing
        ++unseen;
        continue;
      }
      mesh.vertices.push_back(pose.apply(p));
      data.scans.push_back(scan);
      is_coloured = is_coloured && !text.line_is_done();
      if (!is_coloured) continue;
      auto& colour = data.colours.emplace_back();
      for (auto& c : colour) c = text.number<std::uint8_t>("a colour");
    }
  }
  if (!is_coloured) data.colours.clear();
  if (unseen > 0) data.remark = std::to_string(unseen) + " places of the scans' grids hold no point";
  return mesh;
}

}  // namespace dynasurf::io::detail
