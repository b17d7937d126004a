#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// A surface under change: edges collapse, flip and split, and it stays manifold, oriented, of the same genus, and
/// closed or with as many boundary loops as it had. Half-edge h = 3 t + c runs from corner c of triangle t to the next
/// corner. Behind the edges of each loop lie lids, triangles that all meet in a vertex of their own: they close the
/// combinatorics, belong to no surface, and are not alive.
class SurfaceEditor {
 public:
  static constexpr std::uint32_t none = 0xffffffff;
  using Corners = std::array<std::uint32_t, 3>;

  enum class Boundary { none, kept };

  /// Throws InputError unless the mesh is manifold and oriented, with every vertex in use, and closed or allowed to
  /// have a boundary.
  explicit SurfaceEditor(const TriMesh& mesh, Boundary boundary = Boundary::none);

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t from(std::uint32_t h) const { return from_[h]; }
  std::uint32_t to(std::uint32_t h) const { return from_[next(h)]; }
  std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }
  Corners corners(std::uint32_t t) const { return {from_[3 * t], from_[3 * t + 1], from_[3 * t + 2]}; }
  bool is_alive(std::uint32_t t) const { return from_[3 * t] != none && (is_lid_.empty() || !is_lid_[t]); }
  bool has_vertex(std::uint32_t v) const { return out_[v] != none && (v < first_lid_ || v >= end_lids_); }
  /// Of the two half-edges of an edge the one that stands for it; false for all where no triangle of the surface is.
  bool is_edge(std::uint32_t h) const { return is_alive(h / 3) && (h < twin_[h] || !is_alive(twin_[h] / 3)); }
  /// Whether a triangle lies on one side only.
  bool is_boundary_edge(std::uint32_t h) const { return !is_lid_.empty() && is_alive(h / 3) != is_alive(twin_[h] / 3); }
  bool is_on_boundary(std::uint32_t v) const { return !on_boundary_.empty() && on_boundary_[v] != 0; }
  /// A half-edge that leaves v.
  std::uint32_t leaving(std::uint32_t v) const { return out_[v]; }
  /// The half-edge that leaves the same vertex and comes after h counter-clockwise.
  std::uint32_t turned(std::uint32_t h) const { return twin_[previous(h)]; }
  std::size_t triangles() const { return alive_; }
  std::size_t triangle_slots() const { return twin_.size() / 3; }
  std::size_t vertex_slots() const { return positions_.size(); }
  int valence(std::uint32_t v) const;

  std::span<const Vec3> positions() const { return positions_; }
  Vec3& position(std::uint32_t v) { return positions_[v]; }
  const Vec3& position(std::uint32_t v) const { return positions_[v]; }

  /// Whether `collapse` would leave the surface manifold and of the same genus.
  bool can_collapse(std::uint32_t h) const;
  /// Merges both ends of h into its end `to(h)`, which moves to `p`; `from(h)` and two triangles are gone.
  void collapse(std::uint32_t h, const Vec3& p);
  /// Whether the flipped edge is not there already.
  bool can_flip(std::uint32_t h) const;
  /// The edge joins the two opposite corners instead; h stays one of its half-edges.
  void flip(std::uint32_t h);
  /// Puts a new vertex at `p` on the edge, with two more triangles. Returns the vertex.
  std::uint32_t split(std::uint32_t h, const Vec3& p);

  /// The surface without gaps in its numbering; vertices and triangles keep their order. `old_vertex`, where given,
  /// tells which slot each vertex had.
  TriMesh mesh(std::vector<std::uint32_t>* old_vertex = nullptr) const;

 private:
  void pair(std::uint32_t a, std::uint32_t b) {
    twin_[a] = b;
    twin_[b] = a;
  }

  std::vector<Vec3> positions_;
  std::vector<std::uint32_t> out_;                    // per vertex; none: gone
  std::vector<std::uint32_t> from_, twin_;            // per half-edge
  std::vector<std::uint8_t> is_lid_;                  // per triangle; empty where the surface is closed
  std::vector<std::uint8_t> on_boundary_;             // per vertex; likewise
  std::uint32_t first_lid_ = none, end_lids_ = none;  // the vertices that lids meet in
  std::size_t alive_ = 0;
};

/// Tells whether triangles would cut the rest of a surface, by exact predicates. Triangles are kept in cells of space;
/// tell it of every one that changed.
class CrossingGuard {
 public:
  explicit CrossingGuard(const SurfaceEditor& surface);

  /// Triangle t has new corners or positions.
  void update(std::uint32_t t);
  /// Would triangles with these corners, at the surface's present positions, be flat, meet each other or any triangle
  /// of the surface but those in `instead_of`?
  bool would_cross(std::span<const SurfaceEditor::Corners> added, std::span<const std::uint32_t> instead_of);

 private:
  using Cell = std::array<int, 3>;
  void fill();
  void insert(std::uint32_t t);
  Cell cell_of(const Vec3& p) const;
  std::size_t bucket_of(int x, int y, int z) const;

  const SurfaceEditor& surface_;
  double side_ = 1;
  std::vector<std::vector<std::uint32_t>> buckets_;
  std::vector<std::uint32_t> seen_;
  std::uint32_t now_ = 0;
  std::size_t entries_ = 0, entries_at_fill_ = 0;
};

}  // namespace dynasurf::mesh
