#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/detail/marching_loops.hpp"
#include "dynasurf/mesh/marching.hpp"

namespace dynasurf::mesh {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kOutside = -std::numeric_limits<double>::infinity();  // beyond the grid
constexpr double kKeepAway = 1e-3;                                     // from voxel centres, share of an edge

// Corner c of a cell lies at ((c & 1), (c >> 1) & 1, (c >> 2) & 1). Edge a*4 + e runs along axis a.
constexpr int kEdges = 12;

/// The corners of the faces, counter-clockwise seen from outside the cell.
constexpr std::array<std::array<int, 4>, 6> kFaces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// The edge between two neighbouring corners: along the axis in which they differ, numbered by the other two bits.
constexpr int edge_between(int a, int b) {
  const int low = std::min(a, b), axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
  const int u = (low >> ((axis + 1) % 3)) & 1, v = (low >> ((axis + 2) % 3)) & 1;
  return 4 * axis + u + 2 * v;
}

constexpr int low_corner_of(int edge) {
  const int axis = edge / 4;
  return ((edge & 1) << ((axis + 1) % 3)) | (((edge >> 1) & 1) << ((axis + 2) % 3));
}

constexpr std::array<unsigned, kEdges> make_faces_of_edge() {
  std::array<unsigned, kEdges> faces{};
  for (unsigned f = 0; f < 6; ++f)
    for (std::size_t c = 0; c < 4; ++c) faces[edge_between(kFaces[f][c], kFaces[f][(c + 1) % 4])] |= 1u << f;
  return faces;
}
constexpr std::array<unsigned, kEdges> kFacesOfEdge = make_faces_of_edge();

using Cell = std::array<double, 8>;  // values less the level

/// Follows the surface over the faces of a cell: `next[e]` is the edge where the line that comes in at edge e leaves
/// the face; -1 where the surface does not cross. On each face the line has what is above the level to its right, seen
/// from outside the cell, so the lines of all faces join to loops that run counter-clockwise seen from below the level.
std::array<int, kEdges> follow_faces(const Cell& cell) {
  std::array<int, kEdges> next;
  next.fill(-1);
  for (const auto& face : kFaces) {
    std::array<int, 4> enter{}, leave{};
    std::size_t count = 0;
    const auto above = [&](std::size_t c) { return cell[face[c % 4]] >= 0; };
    for (std::size_t c = 0; c < 4; ++c) {
      if (above(c) || !above(c + 1)) continue;
      std::size_t last = c + 1;
      while (above(last + 1)) ++last;
      enter[count] = edge_between(face[c], face[(c + 1) % 4]);
      leave[count++] = edge_between(face[last % 4], face[(last + 1) % 4]);
    }
    if (count == 2) {
      const auto value = [&](std::size_t c) { return cell[face[c]]; };
      const double even = value(0) * value(2), odd = value(1) * value(3);
      const bool is_joined = above(0) ? even > odd : odd > even;
      if (is_joined) std::swap(leave[0], leave[1]);
    }
    for (std::size_t s = 0; s < count; ++s) next[enter[s]] = leave[s];
  }
  return next;
}

struct Loop {
  std::array<int, kEdges> edge;
  std::size_t size = 0;
};

/// Can the loop be cut into triangles from corner `from` without a side that runs within a face? Such a side could be
/// chosen by the neighbouring cell as well, and four triangles would meet in it.
bool fan_stays_inside(const Loop& loop, std::size_t from) {
  const auto faces = [&](std::size_t n) { return kFacesOfEdge[loop.edge[n % loop.size]]; };
  for (std::size_t n = 2; n + 1 < loop.size; ++n)
    if ((faces(from) & faces(from + n)) != 0) return false;
  return true;
}

/// Where vertices lie on the edges of a cell: where the values say, or in the middle (discretised marching cubes).
enum class Placing { interpolated, middles };

/// Walks all cells of a grid, layer by layer, and keeps the vertices of two layers at hand.
class Marching {
 public:
  Marching(const Image& image, double level, GridEdge edge, Placing places = Placing::interpolated)
      : image_(image), level_(level), places_(places), low_(edge == GridEdge::closed ? -1 : 0) {
    for (std::size_t a = 0; a < 3; ++a) high_[a] = image.grid.dims[a] - (edge == GridEdge::closed ? 0 : 1);
    width_ = image.grid.dims[0] + 2;
    const std::size_t layer = width_ * (image.grid.dims[1] + 2);
    for (auto& vertices : in_layer_) vertices.assign(2 * layer, kNone);
    between_.assign(layer, kNone);
    mark_above();
  }

  TriMesh operator()() {
    for (int k = low_; k < high_[2]; ++k) {
      for (int j = low_; j < high_[1]; ++j) visit_row(j, k);
      std::swap(in_layer_[0], in_layer_[1]);
      std::fill(in_layer_[1].begin(), in_layer_[1].end(), kNone);
      std::fill(between_.begin(), between_.end(), kNone);
    }
    return std::move(mesh_);
  }

 private:
  double above_level(int i, int j, int k) const {
    return image_.grid.contains(i, j, k) ? image_(i, j, k) - level_ : kOutside;
  }

  /// One bit for each node, those around the grid included: whether it is above the level.
  void mark_above() {
    const Index3& dims = image_.grid.dims;
    words_ = (width_ + 63) / 64;
    above_.assign(words_ * (dims[1] + 2) * (dims[2] + 2), 0);
    const float* value = image_.values.data();
    for (int k = 0; k < dims[2]; ++k)
      for (int j = 0; j < dims[1]; ++j) {
        std::uint64_t* bits = above_.data() + row_of(j, k);
        for (std::size_t i = 1; i < width_ - 1; ++i, ++value)
          bits[i / 64] |= std::uint64_t{*value - level_ >= 0} << (i % 64);
      }
  }

  std::size_t row_of(int j, int k) const {
    return words_ * index_in({1, image_.grid.dims[1] + 2, 1}, {0, j + 1, k + 1});
  }

  /// Visits the cells of a row that have corners above the level and others below, 64 of them told at a time.
  void visit_row(int j, int k) {
    const std::array<const std::uint64_t*, 4> rows{&above_[row_of(j, k)], &above_[row_of(j + 1, k)],
                                                   &above_[row_of(j, k + 1)], &above_[row_of(j + 1, k + 1)]};
    for (std::size_t w = 0; w < words_; ++w) {
      std::uint64_t any = 0, all = ~std::uint64_t{0};
      for (const std::uint64_t* row : rows) {
        const std::uint64_t next = row[w] >> 1 | (w + 1 < words_ ? (row[w + 1] & 1) << 63 : 0);
        any |= row[w] | next;
        all &= row[w] & next;
      }
      for (std::uint64_t crossed = any & ~all; crossed != 0; crossed &= crossed - 1) {
        const int i = static_cast<int>(64 * w) + std::countr_zero(crossed) - 1;
        if (i >= low_ && i < high_[0]) visit({i, j, k});
      }
    }
  }

  void visit(const Index3& at) {
    Cell cell;
    for (int c = 0; c < 8; ++c) cell[c] = above_level(at[0] + (c & 1), at[1] + ((c >> 1) & 1), at[2] + ((c >> 2) & 1));
    std::array<int, kEdges> next = follow_faces(cell);
    bool is_middle_taken = false;
    for (int start = 0; start < kEdges; ++start) {
      Loop loop;
      for (int e = start; next[e] >= 0;) {
        loop.edge[loop.size++] = e;
        e = std::exchange(next[e], -1);
      }
      if (loop.size == 0) continue;
      if (places_ == Placing::middles)
        is_middle_taken = fill_flat(loop, at, cell, !is_middle_taken) || is_middle_taken;
      else
        fill(loop, at, cell);
    }
  }

  /// Fills a loop with triangles in the few planes that discretised marching cubes knows. Whether it took the middle of
  /// the cell, which one loop of a cell may.
  bool fill_flat(const Loop& loop, const Index3& at, const Cell& cell, bool may_use_middle) {
    std::array<std::uint32_t, kEdges> v{};
    for (std::size_t n = 0; n < loop.size; ++n) v[n] = vertex_on(loop.edge[n], at, cell);
    const FlatFilling filling = flat_filling(std::span(loop.edge).first(loop.size), may_use_middle);
    if (!filling.fan_from_middle) {
      for (const auto& t : filling.triangles) mesh_.triangles.push_back({v[t[0]], v[t[1]], v[t[2]]});
      return false;
    }
    const std::uint32_t middle = mesh_.vertices.size();
    mesh_.vertices.push_back((Vec3(at[0], at[1], at[2]) + Vec3::Constant(0.5)).cwiseProduct(image_.grid.spacing));
    for (std::size_t n = 0; n < loop.size; ++n) mesh_.triangles.push_back({middle, v[n], v[(n + 1) % loop.size]});
    return true;
  }

  void fill(const Loop& loop, const Index3& at, const Cell& cell) {
    std::array<std::uint32_t, kEdges> v{};
    for (std::size_t n = 0; n < loop.size; ++n) v[n] = vertex_on(loop.edge[n], at, cell);
    for (std::size_t from = 0; from < loop.size; ++from) {
      if (!fan_stays_inside(loop, from)) continue;
      for (std::size_t n = 1; n + 1 < loop.size; ++n)
        mesh_.triangles.push_back({v[from], v[(from + n) % loop.size], v[(from + n + 1) % loop.size]});
      return;
    }
    const double count = loop.size;
    Vec3 middle = Vec3::Zero();
    for (std::size_t n = 0; n < loop.size; ++n) middle += mesh_.vertices[v[n]] / count;
    const std::uint32_t centre = mesh_.vertices.size();
    mesh_.vertices.push_back(middle);
    for (std::size_t n = 0; n < loop.size; ++n) mesh_.triangles.push_back({centre, v[n], v[(n + 1) % loop.size]});
  }

  std::uint32_t vertex_on(int edge, const Index3& at, const Cell& cell) {
    const int axis = edge / 4, low = low_corner_of(edge);
    const Index3 from{at[0] + (low & 1), at[1] + ((low >> 1) & 1), at[2] + ((low >> 2) & 1)};
    const std::size_t place = (from[0] + 1) + width_ * (from[1] + 1);
    std::uint32_t& vertex = axis == 2 ? between_[place] : in_layer_[from[2] - at[2]][2 * place + axis];
    if (vertex != kNone) return vertex;
    const double a = cell[low], b = cell[low | (1 << axis)];
    const double share = places_ == Placing::middles || std::isinf(a) || std::isinf(b)
                             ? 0.5
                             : std::clamp(a / (a - b), kKeepAway, 1 - kKeepAway);
    Vec3 p(from[0], from[1], from[2]);
    p[axis] += share;
    vertex = mesh_.vertices.size();
    mesh_.vertices.push_back(p.cwiseProduct(image_.grid.spacing));
    return vertex;
  }

  const Image& image_;
  const double level_;
  const Placing places_;
  const int low_;
  Index3 high_{};
  std::size_t width_ = 0, words_ = 0;  // of a row of nodes, and of its bits
  std::vector<std::uint64_t> above_;
  std::array<std::vector<std::uint32_t>, 2> in_layer_;  // vertices on edges along x and y of the lower, upper layer
  std::vector<std::uint32_t> between_;                  // on edges along z
  TriMesh mesh_;
};

void require_finite(const Image& image, double level) {
  if (!std::isfinite(level)) throw InputError("marching cubes: the level is not finite");
  for (const float v : image.values)
    if (!std::isfinite(v)) throw InputError("marching cubes: a value of the image is not finite");
}

}  // namespace

TriMesh marching_cubes(const Image& image, double level, GridEdge edge) {
  require_finite(image, level);
  return Marching(image, level, edge)();
}

TriMesh discretised_marching_cubes(const Image& image, double level, Facets facets) {
  require_finite(image, level);
  TriMesh mesh = Marching(image, level, GridEdge::closed, Placing::middles)();
  return facets == Facets::merged ? merged_facets(std::move(mesh), image.grid.spacing) : mesh;
}

}  // namespace dynasurf::mesh
