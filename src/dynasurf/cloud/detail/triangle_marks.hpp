#pragma once
#include <cstdint>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// A mark for each triangle or vertex of a mesh; 0: not marked.
using Marks = std::vector<std::uint8_t>;

/// Sets that grow together.
class Groups {
 public:
  explicit Groups(std::size_t count);
  /// The lowest member of the set that `i` is in.
  std::uint32_t find(std::uint32_t i);
  void join(std::uint32_t a, std::uint32_t b);

 private:
  std::vector<std::uint32_t> parent_;
};

/// Sets of the vertices that the marked triangles join.
Groups parts_of(const TriMesh& mesh, const Marks& kept);

/// The normals of all triangles, added up by area, over the area: of length 0 for a closed surface, 0.5 for half a
/// sphere and 1 for a plane.
Vec3 facing_of(const TriMesh& mesh);

/// Takes the mark from the triangles with a marked vertex.
void drop_touching(const TriMesh& mesh, const Marks& of_vertex, Marks& kept);

/// The vertices of the triangles without a mark.
Marks corners_of_dropped(const TriMesh& mesh, const Marks& kept);

/// Where two holes meet in a vertex, the mark is taken from its triangles, until there is no such vertex.
void drop_pinches(const TriMesh& mesh, Marks& kept);

}  // namespace dynasurf::cloud
