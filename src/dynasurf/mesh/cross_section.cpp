#include <unordered_map>

#include "dynasurf/core/detail/edge_key.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::mesh {
namespace {

/// The piece of a cut triangle: it runs from one cut side to another. Following the pieces from side to side gives the
/// polygons. A vertex on the plane counts as above it, so every triangle is cut in two sides or in none.
struct Piece {
  std::uint64_t from, to;  // names of the cut sides
  Vec3 from_point, to_point;
  bool used = false;
};

class Cut {
 public:
  Cut(const TriMesh& mesh, const Vec3& point, const Vec3& normal) : mesh_(mesh), height_(mesh.vertices.size()) {
    for (std::size_t v = 0; v < height_.size(); ++v) height_[v] = (mesh.vertices[v] - point).dot(normal);
  }

  std::vector<Piece> pieces() const {
    std::vector<Piece> result;
    for (const auto& t : mesh_.triangles) {
      Piece piece{};
      bool is_cut = false;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t a = t[c], b = t[(c + 1) % 3];
        if (above(a) == above(b)) continue;
        is_cut = true;
        // Downwards the piece begins, upwards it ends: counter-clockwise about the normal for an outer surface.
        (above(a) ? piece.from : piece.to) = edge_key(a, b);
        (above(a) ? piece.from_point : piece.to_point) = crossing(std::min(a, b), std::max(a, b));
      }
      if (is_cut) result.push_back(piece);
    }
    return result;
  }

 private:
  bool above(std::uint32_t v) const { return height_[v] >= 0; }

  // Always computed from the lower to the higher number, so that both triangles of a side see the same bytes.
  Vec3 crossing(std::uint32_t a, std::uint32_t b) const {
    const double share = height_[a] / (height_[a] - height_[b]);
    return mesh_.vertices[a] + share * (mesh_.vertices[b] - mesh_.vertices[a]);
  }

  const TriMesh& mesh_;
  std::vector<double> height_;
};

void append(std::vector<Vec3>& polygon, const Vec3& p) {
  // Several sides meet the plane in one point where a vertex lies on it.
  if (polygon.empty() || polygon.back() != p) polygon.push_back(p);
}

}  // namespace

std::vector<std::vector<Vec3>> cross_section(const TriMesh& mesh, const Vec3& point, const Vec3& normal) {
  std::vector<Piece> pieces = Cut(mesh, point, normal).pieces();
  std::unordered_map<std::uint64_t, std::size_t> begins_at, ends_at;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    begins_at.try_emplace(pieces[p].from, p);
    ends_at.try_emplace(pieces[p].to, p);
  }

  std::vector<std::vector<Vec3>> polygons;
  const auto follow = [&](std::size_t first) {
    std::vector<Vec3> polygon{pieces[first].from_point};
    const std::uint64_t start = pieces[first].from;
    for (std::size_t p = first;;) {
      pieces[p].used = true;
      append(polygon, pieces[p].to_point);
      const auto next = begins_at.find(pieces[p].to);
      if (pieces[p].to == start || next == begins_at.end() || pieces[next->second].used) break;
      p = next->second;
    }
    // A surface that only touches the plane leaves a point or a line there and back, not a polygon.
    if (polygon.size() > 3 || (polygon.size() > 1 && polygon.front() != polygon.back()))
      polygons.push_back(std::move(polygon));
  };
  // Open lines first: they must be followed from their beginning at the mesh's boundary.
  for (std::size_t p = 0; p < pieces.size(); ++p)
    if (!pieces[p].used && !ends_at.contains(pieces[p].from)) follow(p);
  for (std::size_t p = 0; p < pieces.size(); ++p)
    if (!pieces[p].used) follow(p);
  return polygons;
}

}  // namespace dynasurf::mesh
