#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// Where a surface meets itself.
struct SelfIntersections {
  std::vector<std::array<std::uint32_t, 2>> pairs;  // triangles that meet elsewhere than in their common vertices
  std::vector<std::uint32_t> flat;                  // triangles whose corners lie exactly on one line
  bool free() const { return pairs.empty() && flat.empty(); }
};

/// Finds all pairs of triangles that cut or touch each other. Triangles may share a vertex or an edge by *index*; any
/// further common point counts: a crossing, a fold onto the neighbour, a twin, a corner that touches a face, and also
/// vertices of different index in the same place. Flat triangles are reported as such and not paired.
/// Decided exactly for the coordinates as stored: no tolerance, no missed and no false pair. The first triangle of a
/// pair is the lower one; pairs and flat triangles are sorted. The same for any number of threads.
/// Throws InputError for a vertex that is not finite or an index out of range.
SelfIntersections self_intersections(const TriMesh& mesh);

/// Do two triangles, neither of them flat, have a point in common beside the corners that they share by index? Exact.
bool triangles_meet(std::span<const Vec3> vertices, const std::array<std::uint32_t, 3>& s,
                    const std::array<std::uint32_t, 3>& t);

/// Do three points lie exactly on one line?
bool is_flat(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace dynasurf::mesh
