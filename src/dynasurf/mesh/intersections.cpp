#include "dynasurf/mesh/intersections.hpp"

#include <algorithm>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/box_tree.hpp"
#include "dynasurf/mesh/detail/predicates.hpp"

namespace dynasurf::mesh {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// An axis along which the triangle casts a shadow of some area; -1 for a flat triangle.
int shadow_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis)
    if (orient2d(a, b, c, axis) != 0) return axis;
  return -1;
}

/// For a point on the line through p and q, seen along an axis: is it between them, ends included?
bool is_between(const Vec3& p, const Vec3& q, const Vec3& x, int left_out) {
  for (const int axis : {(left_out + 1) % 3, (left_out + 2) % 3})
    if (x[axis] < std::min(p[axis], q[axis]) || x[axis] > std::max(p[axis], q[axis])) return false;
  return true;
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, int left_out) {
  const int pqr = orient2d(p, q, r, left_out), pqs = orient2d(p, q, s, left_out);
  const int rsp = orient2d(r, s, p, left_out), rsq = orient2d(r, s, q, left_out);
  if (pqr * pqs < 0 && rsp * rsq < 0) return true;
  return (pqr == 0 && is_between(p, q, r, left_out)) || (pqs == 0 && is_between(p, q, s, left_out)) ||
         (rsp == 0 && is_between(r, s, p, left_out)) || (rsq == 0 && is_between(r, s, q, left_out));
}

bool is_inside(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c, int left_out) {
  const int ab = orient2d(a, b, x, left_out), bc = orient2d(b, c, x, left_out), ca = orient2d(c, a, x, left_out);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

/// Does the closed segment p q meet the closed triangle a b c? The triangle is not flat.
bool segment_meets(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int of_p = orient3d(a, b, c, p), of_q = orient3d(a, b, c, q);
  if (of_p * of_q > 0) return false;
  if (of_p == 0 && of_q == 0) {
    const int axis = shadow_axis(a, b, c);
    return is_inside(p, a, b, c, axis) || segments_meet(p, q, a, b, axis) || segments_meet(p, q, b, c, axis) ||
           segments_meet(p, q, c, a, axis);
  }
  // The line meets the plane in one point of the segment. It is in the triangle when the line passes all edges on the
  // same side.
  const int ab = orient3d(p, q, a, b), bc = orient3d(p, q, b, c), ca = orient3d(p, q, c, a);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

/// The corners of `t` with those it shares with `other` first, in their order in `t`.
Corners shared_first(const Corners& t, const Corners& other, int& shared) {
  Corners sorted = t;
  const auto end = std::stable_partition(sorted.begin(), sorted.end(), [&](std::uint32_t v) {
    return std::find(other.begin(), other.end(), v) != other.end();
  });
  shared = end - sorted.begin();
  return sorted;
}

}  // namespace

bool is_flat(const Vec3& a, const Vec3& b, const Vec3& c) { return shadow_axis(a, b, c) < 0; }

bool triangles_meet(std::span<const Vec3> vertices, const Corners& s, const Corners& t) {
  int shared = 0;
  const Corners a = shared_first(s, t, shared), b = shared_first(t, s, shared);
  const auto p = [&](int i) -> const Vec3& { return vertices[a[i]]; };
  const auto q = [&](int i) -> const Vec3& { return vertices[b[i]]; };
  switch (shared) {
    case 0:
      for (int i = 0; i < 3; ++i) {
        if (segment_meets(p(i), p((i + 1) % 3), q(0), q(1), q(2))) return true;
        if (segment_meets(q(i), q((i + 1) % 3), p(0), p(1), p(2))) return true;
      }
      return false;
    case 1:
      // Whatever they share more begins in the common vertex and leaves one of them through its opposite edge.
      return segment_meets(p(1), p(2), q(0), q(1), q(2)) || segment_meets(q(1), q(2), p(0), p(1), p(2));
    case 2: {
      // Beside the common edge they meet only when one is folded onto the other.
      if (orient3d(p(0), p(1), p(2), q(2)) != 0) return false;
      const int axis = shadow_axis(p(0), p(1), p(2));
      return orient2d(p(0), p(1), p(2), axis) == orient2d(p(0), p(1), q(2), axis);
    }
    default:
      return true;  // twins
  }
}

namespace {

void check(const TriMesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!mesh.vertices[v].allFinite()) throw InputError("vertex " + std::to_string(v) + " is not finite");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const auto v : mesh.triangles[t])
      if (v >= mesh.vertices.size())
        throw InputError("triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " +
                         std::to_string(mesh.vertices.size()));
}

}  // namespace

SelfIntersections self_intersections(const TriMesh& mesh) {
  check(mesh);
  SelfIntersections found;
  const std::size_t count = mesh.triangles.size();
  std::vector<std::uint8_t> flat(count);
  std::vector<Box> boxes(count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    flat[t] = is_flat(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    if (flat[t]) found.flat.push_back(t);
    for (const auto v : {a, b, c}) boxes[t].hold(mesh.vertices[v]);
  }

  const BoxTree tree(boxes);
  constexpr std::size_t grain = 256;
  std::vector<std::vector<std::array<std::uint32_t, 2>>> pieces((count + grain - 1) / grain);
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    auto& piece = pieces[begin / grain];
    for (std::size_t s = begin; s < end; ++s) {
      if (flat[s]) continue;
      const std::uint32_t first = s;
      const auto meets = [&](const Box& box) { return box.meets(boxes[first]); };
      tree.walk(meets, [&](std::uint32_t i) {
        const std::uint32_t t = tree.order()[i];
        if (t > first && !flat[t] && meets(boxes[t]) &&
            triangles_meet(mesh.vertices, mesh.triangles[s], mesh.triangles[t]))
          piece.push_back({first, t});
      });
    }
    std::sort(piece.begin(), piece.end());
  });
  for (const auto& piece : pieces) found.pairs.insert(found.pairs.end(), piece.begin(), piece.end());
  return found;
}

}  // namespace dynasurf::mesh
