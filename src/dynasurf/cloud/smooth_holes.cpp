#include <cmath>
#include <vector>

#include <Eigen/SparseCholesky>

#include "dynasurf/cloud/levels.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/relax.hpp"

namespace dynasurf {
namespace {

constexpr std::uint32_t fixed = 0xffffffff;

/// The free vertices, numbered; the others are `fixed`.
struct Free {
  std::vector<std::uint32_t> number;  // per vertex slot
  std::vector<std::uint32_t> slots;
};

Free far_from(const SurfaceEditor& s, const Neighbours& points, double reach) {
  std::vector<std::uint8_t> is_far(s.vertex_slots(), 0);
  parallel_for(is_far.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      is_far[v] = s.has_vertex(static_cast<std::uint32_t>(v)) &&
                  points.nearest(s.position(static_cast<std::uint32_t>(v))).distance2 > reach * reach;
  });
  Free f{std::vector<std::uint32_t>(is_far.size(), fixed), {}};
  for (std::uint32_t v = 0; v < is_far.size(); ++v)
    if (is_far[v]) {
      f.number[v] = static_cast<std::uint32_t>(f.slots.size());
      f.slots.push_back(v);
    }
  return f;
}

std::vector<std::uint32_t> ring_of(const SurfaceEditor& s, std::uint32_t v) {
  std::vector<std::uint32_t> ring;
  std::uint32_t h = s.leaving(v);
  do {
    ring.push_back(s.to(h));
    h = s.turned(h);
  } while (h != s.leaving(v));
  return ring;
}

/// Free vertices go where the sum of all squared differences to the mean of the neighbours is smallest; two rings of
/// fixed vertices tell how the surface arrives.
void bend_least(SurfaceEditor& s, const Free& f) {
  std::vector<std::uint8_t> has_row(s.vertex_slots(), 0);
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<Vec3> right;
  const auto add_row = [&](std::uint32_t v) {
    if (has_row[v]) return;
    has_row[v] = 1;
    const auto row = static_cast<int>(right.size());
    right.push_back(Vec3::Zero());
    const std::vector<std::uint32_t> ring = ring_of(s, v);
    const auto add = [&](std::uint32_t u, double weight) {
      if (f.number[u] == fixed)
        right.back() -= weight * s.position(u);
      else
        entries.emplace_back(row, static_cast<int>(f.number[u]), weight);
    };
    add(v, 1);
    for (const std::uint32_t u : ring) add(u, -1.0 / static_cast<double>(ring.size()));
  };
  for (const std::uint32_t v : f.slots) {
    add_row(v);
    for (const std::uint32_t u : ring_of(s, v)) add_row(u);
  }
  Eigen::SparseMatrix<double> rows(static_cast<Eigen::Index>(right.size()), static_cast<Eigen::Index>(f.slots.size()));
  rows.setFromTriplets(entries.begin(), entries.end());
  Eigen::MatrixX3d target(static_cast<Eigen::Index>(right.size()), 3);
  for (std::size_t r = 0; r < right.size(); ++r) target.row(static_cast<Eigen::Index>(r)) = right[r].transpose();
  const Eigen::SparseMatrix<double> square = rows.transpose() * rows;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(square);
  if (solver.info() != Eigen::Success) return;
  const Eigen::MatrixX3d sums = rows.transpose() * target;
  const Eigen::MatrixX3d places = solver.solve(sums);
  if (!places.allFinite()) return;
  for (std::size_t i = 0; i < f.slots.size(); ++i)
    s.position(f.slots[i]) = places.row(static_cast<Eigen::Index>(i)).transpose();
}

/// Splits edges of the free part that bending has made long.
void split_long(SurfaceEditor& s, const Free& f, double length) {
  const std::size_t half_edges = 3 * s.triangle_slots(), known = f.number.size();
  for (std::uint32_t h = 0; h < half_edges; ++h) {
    if (!s.is_alive(h / 3) || h > s.twin(h)) continue;
    const std::uint32_t a = s.from(h), b = s.to(h);
    if (a >= known || b >= known || f.number[a] == fixed || f.number[b] == fixed) continue;
    if ((s.position(a) - s.position(b)).norm() > length) s.split(h, Vec3(0.5 * (s.position(a) + s.position(b))));
  }
}

std::vector<Vec3> places_of(const SurfaceEditor& s) { return {s.positions().begin(), s.positions().end()}; }

}  // namespace

std::optional<TriMesh> with_smooth_holes(const TriMesh& fine, const Neighbours& points, double reach,
                                         std::size_t triangles) {
  constexpr int rounds = 4;
  constexpr double worth_it = 0.01;  // of the vertices
  SurfaceEditor whole(fine);
  const auto share =
      static_cast<double>(far_from(whole, points, reach).slots.size()) / static_cast<double>(fine.vertices.size());
  if (share < worth_it) return std::nullopt;
  make_lighter(whole, triangles);
  SurfaceEditor s(whole.mesh());
  double length = 0;
  for (const double size : local_sizes(s, 0)) length += size / static_cast<double>(s.vertex_slots());
  for (int k = 0; k < rounds; ++k) {
    const Free f = far_from(s, points, reach);
    std::vector<Vec3> safe = places_of(s);
    bend_least(s, f);
    take_back_crossings(s, safe);
    if (k + 1 < rounds) split_long(s, f, 1.5 * length);
    flip_to_larger_angles(s, 30);
    safe = places_of(s);
    const TriMesh here = s.mesh();
    relax(s, std::vector<double>(s.vertex_slots(), length), ClosestPoint(here), here, 2, 25, 60);
    take_back_crossings(s, safe);
  }
  return s.mesh();
}

}  // namespace dynasurf
