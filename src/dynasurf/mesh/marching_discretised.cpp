#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "dynasurf/mesh/detail/marching_loops.hpp"
#include "dynasurf/mesh/detail/surface_editor.hpp"

namespace dynasurf::mesh {
namespace {

using Places = std::vector<Vec3>;  // twice the place in the cell: whole numbers

/// Twice the place of the middle of an edge of the cell [0, 1]^3.
Vec3 middle_of(int edge) {
  const int axis = edge / 4;
  Vec3 p = Vec3::Zero();
  p[axis] = 1;
  p[(axis + 1) % 3] = 2 * (edge & 1);
  p[(axis + 2) % 3] = 2 * ((edge >> 1) & 1);
  return p;
}

bool share_a_face(const Vec3& a, const Vec3& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a[axis] == b[axis] && a[axis] != 1) return true;
  return false;
}

/// Whether the plane's normal has components of one size and zeros only.
bool is_plain(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a).cwiseAbs();
  const double most = n.maxCoeff();
  for (int axis = 0; axis < 3; ++axis)
    if (n[axis] != 0 && n[axis] != most) return false;
  return most > 0;
}

/// The best triangulation of the part of a loop between two of its corners, by dynamic programming.
class LoopCutter {
 public:
  explicit LoopCutter(const Places& at) : at_(at), best_(at.size() * at.size()) {}

  /// The fewest triangles out of the plain planes; absent where a side would lie within a face.
  std::optional<int> cost() { return cost(0, at_.size() - 1); }
  void collect(FlatFilling& filling) { collect(0, at_.size() - 1, filling); }

 private:
  struct Part {
    bool is_known = false;
    std::optional<int> cost;
    std::size_t apex = 0;
  };

  bool is_allowed(std::size_t from, std::size_t to) const {
    return to - from == 1 || (from == 0 && to + 1 == at_.size()) || !share_a_face(at_[from], at_[to]);
  }
  std::optional<int> cost(std::size_t from, std::size_t to) {
    if (to - from < 2) return 0;
    Part& part = best_[from * at_.size() + to];
    if (part.is_known) return part.cost;
    part.is_known = true;
    for (std::size_t apex = from + 1; apex < to; ++apex) {
      if (!is_allowed(from, apex) || !is_allowed(apex, to)) continue;
      const auto left = cost(from, apex), right = cost(apex, to);
      if (!left || !right) continue;
      const int all = *left + *right + (is_plain(at_[from], at_[apex], at_[to]) ? 0 : 1);
      if (!part.cost || all < *part.cost) part.cost = all, part.apex = apex;
    }
    return part.cost;
  }
  void collect(std::size_t from, std::size_t to, FlatFilling& filling) {
    if (to - from < 2) return;
    const std::size_t apex = best_[from * at_.size() + to].apex;
    collect(from, apex, filling);
    filling.triangles.push_back({from, apex, to});
    collect(apex, to, filling);
  }

  const Places& at_;
  std::vector<Part> best_;
};

/// Would the triangles around a vertex that is merged along half-edge h stay where they are? The worst of their shapes.
std::optional<double> merged_shape(const SurfaceEditor& surface, std::uint32_t h, const Vec3& spacing) {
  using Editor = SurfaceEditor;
  const Vec3 &v = surface.position(surface.from(h)), &w = surface.position(surface.to(h));
  double worst = std::numeric_limits<double>::infinity();
  for (std::uint32_t g = surface.turned(h); g != h; g = surface.turned(g)) {
    if (surface.twin(h) / 3 == g / 3) continue;  // gone afterwards, like that of h
    const Vec3 &b = surface.position(surface.to(g)), &c = surface.position(surface.to(Editor::next(g)));
    const Vec3 old = (b - v).cross(c - v), now = (b - w).cross(c - w);
    if (!old.cross(now).isZero(0) || !(old.dot(now) > 0)) return std::nullopt;
    const Vec3 mm = (b - w).cwiseProduct(spacing), other = (c - w).cwiseProduct(spacing);
    worst =
        std::min(worst, mm.cross(other).norm() / (mm.squaredNorm() + other.squaredNorm() + (mm - other).squaredNorm()));
  }
  return worst;
}

/// Merges a vertex into the neighbour that leaves the best triangles; whether one could.
bool merge(SurfaceEditor& surface, std::uint32_t v, const Vec3& spacing) {
  double best = 0;
  std::optional<std::uint32_t> chosen;
  const std::uint32_t first = surface.leaving(v);
  std::uint32_t h = first;
  do {
    const std::optional<double> shape = merged_shape(surface, h, spacing);
    if (shape && *shape > best && surface.can_collapse(h)) best = *shape, chosen = h;
    h = surface.turned(h);
  } while (h != first);
  if (!chosen) return false;
  surface.collapse(*chosen, surface.position(surface.to(*chosen)));
  return true;
}

}  // namespace

FlatFilling flat_filling(std::span<const int> loop, bool may_use_middle) {
  Places at;
  for (const int edge : loop) at.push_back(middle_of(edge));
  LoopCutter cutter(at);
  const std::optional<int> cost = cutter.cost();
  const Vec3 middle = Vec3::Ones();
  int fan_cost = 0;
  for (std::size_t n = 0; n < at.size(); ++n) fan_cost += is_plain(middle, at[n], at[(n + 1) % at.size()]) ? 0 : 1;
  FlatFilling filling;
  // Without a way to cut it, a loop takes the middle in any case.
  filling.fan_from_middle = !cost || (may_use_middle && fan_cost < *cost);
  if (!filling.fan_from_middle) cutter.collect(filling);
  return filling;
}

TriMesh merged_facets(TriMesh mesh, const Vec3& spacing) {
  if (mesh.triangles.empty()) return mesh;
  // On the lattice of half voxels all numbers are whole, and what is said of planes is exact.
  for (Vec3& p : mesh.vertices) p = (2 * p.cwiseQuotient(spacing)).array().round();
  SurfaceEditor surface(mesh);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t v = 0; v < surface.vertex_slots(); ++v)
      if (surface.has_vertex(v)) changed = merge(surface, v, spacing) || changed;
  }
  mesh = surface.mesh();
  for (Vec3& p : mesh.vertices) p = (p / 2).cwiseProduct(spacing);
  return mesh;
}

}  // namespace dynasurf::mesh
