#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/cloud/detail/loops.hpp"
#include "dynasurf/mesh/detail/surface_editor.hpp"

namespace dynasurf::cloud {

/// A new piece of surface over one hole, or between two.
struct Patch {
  mesh::SurfaceEditor surface;       // closed; other holes are covered by fans of triangles
  std::uint32_t first_vertex = 0;    // slots from here on are the patch's own
  std::uint32_t first_triangle = 0;  // slots from here on are the patch
  std::vector<std::uint32_t> rim;    // vertices where the patch meets the surface
  double bending = 0;                // integral of the squared mean curvature over the patch: no unit

  /// The vertices of the rim, then the patch's own.
  std::uint32_t vertex(std::size_t i) const { return i < rim.size() ? rim[i] : first_vertex + (i - rim.size()); }
};

/// Closes the loop `a` of an open surface, or with `b` joins two loops by a tube, with triangles about as large as
/// those around. The patch leaves the surface in the direction in which that arrives, and its mean curvature goes as
/// evenly as can be from rim to rim: a hole in a sphere becomes sphere, a gap in a tube becomes tube (after Schneider
/// and Kobbelt, Geometric fairing of irregular meshes, 2001). It may cross the rest of the surface.
Patch make_patch(const TriMesh& open, std::span<const Loop> loops, std::size_t a, std::optional<std::size_t> b = {});

/// Closes the loop `a` of an open surface with about the least area, with triangles about as large as those around:
/// flat over a loop that lies in a plane. Its `bending` is not told. It may cross the rest of the surface.
Patch make_flat_lid(const TriMesh& open, std::span<const Loop> loops, std::size_t a);

}  // namespace dynasurf::cloud
