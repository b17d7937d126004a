#include "dynasurf/mesh/tetrahedra.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::mesh {
namespace {

double six_volumes(const TetMesh& solid, const std::array<std::uint32_t, 4>& t) {
  const Vec3& a = solid.vertices[t[0]];
  return (solid.vertices[t[1]] - a).cross(solid.vertices[t[2]] - a).dot(solid.vertices[t[3]] - a);
}

/// Three tetrahedra of a prism; `lower` and `upper` are the numbers of its layers' first vertices. With the corners in
/// the order of their numbers each side is cut from its lowest corner below, whichever prism looks at it.
void add_prism(TetMesh& solid, std::array<std::uint32_t, 3> corners, std::uint32_t lower, std::uint32_t upper) {
  bool is_odd = false;
  const auto order = [&](std::size_t i, std::size_t j) {
    if (corners[i] <= corners[j]) return;
    std::swap(corners[i], corners[j]);
    is_odd = !is_odd;
  };
  order(0, 1), order(1, 2), order(0, 1);
  const auto [a, b, c] = corners;
  const std::array<std::array<std::uint32_t, 4>, 3> pieces{{{lower + a, lower + b, lower + c, upper + c},
                                                            {lower + a, lower + b, upper + c, upper + b},
                                                            {lower + a, upper + b, upper + c, upper + a}}};
  for (std::array<std::uint32_t, 4> piece : pieces) {
    if (is_odd) std::swap(piece[0], piece[1]);
    solid.tetrahedra.push_back(piece);
  }
}

}  // namespace

TetMesh fill_between(const TriMesh& inner, const TriMesh& outer, int layers) {
  if (inner.vertices.size() != outer.vertices.size() || inner.triangles != outer.triangles)
    throw InputError("fill_between: the surfaces have different triangles; expected the same ones");
  if (layers < 1) throw InputError("fill_between: " + std::to_string(layers) + " layers; expected at least 1");
  const std::uint32_t count = inner.vertices.size();
  TetMesh solid;
  for (int layer = 0; layer <= layers; ++layer) {
    const double share = 1.0 * layer / layers;
    for (std::uint32_t v = 0; v < count; ++v)
      solid.vertices.push_back((1 - share) * inner.vertices[v] + share * outer.vertices[v]);
  }
  for (int layer = 0; layer < layers; ++layer)
    for (const auto& t : inner.triangles) add_prism(solid, t, layer * count, (layer + 1) * count);
  return solid;
}

double volume_mm3(const TetMesh& solid) {
  double six = 0;
  for (const auto& t : solid.tetrahedra) six += six_volumes(solid, t);
  return six / 6;
}

TetQuality tet_quality(const TetMesh& solid) {
  TetQuality q;
  q.count = solid.tetrahedra.size();
  if (q.count == 0) return q;
  q.volume_min = q.shape_min = std::numeric_limits<double>::infinity();
  q.volume_max = -q.volume_min;
  for (const auto& t : solid.tetrahedra) {
    const double volume = six_volumes(solid, t) / 6;
    double squares = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) squares += (solid.vertices[t[i]] - solid.vertices[t[j]]).squaredNorm();
    // The mean ratio: 1 for a regular tetrahedron, 0 for a flat one.
    const double shape = volume > 0 ? 12 * own::pow(3 * volume, 2.0 / 3) / squares : 0;
    q.not_positive += !(volume > 0);
    q.volume_min = std::min(q.volume_min, volume), q.volume_max = std::max(q.volume_max, volume);
    q.shape_min = std::min(q.shape_min, shape);
    q.volume_mean += volume / q.count, q.shape_mean += shape / q.count;
  }
  return q;
}

}  // namespace dynasurf::mesh
