#include <algorithm>
#include <bit>
#include <cmath>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/mesh/detail/surface_editor.hpp"
#include "dynasurf/mesh/intersections.hpp"

namespace dynasurf::mesh {
namespace {

using Corners = SurfaceEditor::Corners;

Eigen::AlignedBox3d box_of(std::span<const Vec3> p, const Corners& t) {
  Eigen::AlignedBox3d box(p[t[0]]);
  box.extend(p[t[1]]);
  box.extend(p[t[2]]);
  return box;
}

bool is_corner(std::uint32_t v, const Corners& t) { return v == t[0] || v == t[1] || v == t[2]; }

/// Do the corners of s that are not t's lie clearly on one side of t's plane? Then nothing else can be common.
bool is_clear_of_plane(std::span<const Vec3> p, const Corners& s, const Corners& t) {
  const Vec3 u = p[t[1]] - p[t[0]], w = p[t[2]] - p[t[0]], n = u.cross(w);
  int side = 0;
  for (const std::uint32_t v : s) {
    if (is_corner(v, t)) continue;
    const Vec3 d = p[v] - p[t[0]];
    const double height = n.dot(d);
    // Far above the rounding errors of the formula.
    const double doubt = 1e-13 * (u.lpNorm<1>() * w.lpNorm<1>() * (d.lpNorm<1>() + 1e-3));
    const int here = height > doubt ? 1 : height < -doubt ? -1 : 0;
    if (here == 0 || here == -side) return false;
    side = here;
  }
  return side != 0;
}

bool meet(std::span<const Vec3> p, const Corners& s, const Corners& t) {
  return !is_clear_of_plane(p, s, t) && !is_clear_of_plane(p, t, s) && triangles_meet(p, s, t);
}

}  // namespace

CrossingGuard::CrossingGuard(const SurfaceEditor& surface) : surface_(surface) { fill(); }

void CrossingGuard::fill() {
  double length = 0;
  for (std::uint32_t t = 0; t < surface_.triangle_slots(); ++t)
    if (surface_.is_alive(t)) {
      const Corners c = surface_.corners(t);
      length += (surface_.position(c[1]) - surface_.position(c[0])).norm();
    }
  // Cells a little larger than a mean edge: a triangle lies in a few cells, and a cell holds a few triangles.
  side_ = std::max(1.2 * length / std::max<std::size_t>(1, surface_.triangles()), 1e-300);
  buckets_.assign(std::bit_ceil(2 * surface_.triangles() + 1), {});
  entries_ = 0;
  for (std::uint32_t t = 0; t < surface_.triangle_slots(); ++t)
    if (surface_.is_alive(t)) insert(t);
  entries_at_fill_ = entries_;
}

CrossingGuard::Cell CrossingGuard::cell_of(const Vec3& p) const {
  const auto whole = [&](double x) { return floor_int(std::clamp(x / side_, -1e9, 1e9)); };
  return {whole(p[0]), whole(p[1]), whole(p[2])};
}

std::size_t CrossingGuard::bucket_of(int x, int y, int z) const {
  const std::uint64_t h = static_cast<std::uint32_t>(x) * 0x9e3779b97f4a7c15u ^
                          static_cast<std::uint32_t>(y) * 0xc2b2ae3d27d4eb4fu ^
                          static_cast<std::uint32_t>(z) * 0x165667b19e3779f9u;
  // Cells that fall into one bucket cost looks and nothing else: triangles are tested by themselves.
  return (h ^ h >> 31) & (buckets_.size() - 1);
}

void CrossingGuard::insert(std::uint32_t t) {
  const auto box = box_of(surface_.positions(), surface_.corners(t));
  const Cell low = cell_of(box.min()), high = cell_of(box.max());
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        auto& bucket = buckets_[bucket_of(x, y, z)];
        if (!bucket.empty() && bucket.back() == t) continue;
        bucket.push_back(t);
        ++entries_;
      }
}

// Entries of former positions stay: a look at one finds the triangle as it is, and they are swept when they are many.
void CrossingGuard::update(std::uint32_t t) {
  if (entries_ > 3 * entries_at_fill_ + 1000) fill();
  if (surface_.is_alive(t)) insert(t);
}

bool CrossingGuard::would_cross(std::span<const Corners> added, std::span<const std::uint32_t> instead_of) {
  const std::span<const Vec3> p = surface_.positions();
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (is_flat(p[added[i][0]], p[added[i][1]], p[added[i][2]])) return true;
    for (std::size_t j = 0; j < i; ++j)
      if (meet(p, added[i], added[j])) return true;
  }
  seen_.resize(surface_.triangle_slots(), 0);
  for (const Corners& s : added) {
    ++now_;
    // A stamp for each triangle in question: no list of those that were seen has to be cleared.
    for (const std::uint32_t t : instead_of) seen_[t] = now_;
    const auto box = box_of(p, s);
    const Cell low = cell_of(box.min()), high = cell_of(box.max());
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x)
          for (const std::uint32_t t : buckets_[bucket_of(x, y, z)]) {
            if (seen_[t] == now_ || !surface_.is_alive(t)) continue;
            seen_[t] = now_;
            const Corners c = surface_.corners(t);
            if (box_of(p, c).intersects(box) && meet(p, s, c)) return true;
          }
  }
  return false;
}

}  // namespace dynasurf::mesh
