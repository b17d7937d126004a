#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/mesh/detail/surface_editor.hpp"

namespace dynasurf::cloud {

/// The vertices around a hole of an open surface, in the direction of the surface's own triangles.
using Loop = std::vector<std::uint32_t>;

/// All loops of an open surface, those that start at the lowest vertex first. Needs a manifold, oriented surface that
/// touches itself in no single vertex.
std::vector<Loop> loops_of(const TriMesh& open);

/// Where a loop is, and where the surface runs to over it: `aim` is the mean of the directions in which it leaves, near
/// 1 long at the end of a tube and near 0 around a hole in a wall.
struct Rim {
  Vec3 middle = Vec3::Zero(), aim = Vec3::Zero();
  double length = 0;
};

/// The rim of each loop of an open surface, in their order.
std::vector<Rim> rims_of(const TriMesh& open, std::span<const Loop> loops);

/// A new piece of surface over one hole, or between two.
struct Patch {
  mesh::SurfaceEditor surface;       // closed; other holes are covered by fans of triangles
  std::uint32_t first_vertex = 0;    // slots from here on are the patch's own
  std::uint32_t first_triangle = 0;  // slots from here on are the patch
  std::vector<std::uint32_t> rim;    // vertices where the patch meets the surface
  double bending = 0;                // integral of the squared mean curvature over the patch: no unit
};

/// Closes the loop `a` of an open surface, or with `b` joins two loops by a tube, with triangles about as large as
/// those around. The patch leaves the surface in the direction in which that arrives, and its mean curvature goes as
/// evenly as can be from rim to rim: a hole in a sphere becomes sphere, a gap in a tube becomes tube (after Schneider
/// and Kobbelt, Geometric fairing of irregular meshes, 2001). It may cross the rest of the surface.
Patch make_patch(const TriMesh& open, std::span<const Loop> loops, std::size_t a, std::optional<std::size_t> b = {});

}  // namespace dynasurf::cloud
