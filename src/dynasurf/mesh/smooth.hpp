#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// The thesis's smoothing by angle deficit (GEO-SMOOTH, thesis 5.5).
struct Smoothing {
  double tolerance_rad = 0.2;
  double step_mm = 0;
  bool literal_step = false;
  int sweeps = 1;
};
void describe(auto& visit, Smoothing& o) {
  visit("tolerance_rad", o.tolerance_rad,
        OptionInfo{"a vertex is a peak when its angles miss 2 pi by more (thesis 5.3)", "rad", 0, 6.3});
  visit("step_mm", o.step_mm,
        OptionInfo{"length of one move towards the neighbours' centroid; 0: smallest voxel side / 20", "mm", 0, 100});
  visit("literal_step", o.literal_step,
        OptionInfo{"read the thesis literally: the step is a share of the way, not a length"});
  visit("sweeps", o.sweeps, OptionInfo{"passes over the vertices; 0 does nothing", "", 0, 10000});
}

/// What smoothing did in its last sweep.
struct SmoothReport {
  int moved = 0;        // vertices moved in the last sweep
  int at_centroid = 0;  // of them, those that ended in the centroid with a peak left
};

/// Moves peaks towards the centroid of their ring, in place, in vertex order. Boundary vertices and those with
/// `pinned[v] != 0` stay (`pinned` may be empty). Never changes the topology. `smallest_spacing_mm` gives the step
/// when `step_mm` is 0.
SmoothReport smooth(TriMesh& mesh, const Smoothing& options, double smallest_spacing_mm,
                    const std::vector<std::uint8_t>& pinned = {});

/// Neighbours of each vertex in the order of its fan; none for vertices of the boundary, of no triangle, or where
/// several fans meet. They depend on the triangles alone: find them once, smooth many times.
struct VertexRings {
  std::vector<std::uint32_t> first;       // vertices + 1 offsets into `neighbours`
  std::vector<std::uint32_t> neighbours;  // ring after ring
  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(neighbours).subspan(first[vertex], first[vertex + 1] - first[vertex]);
  }
};
/// Finds the rings of all vertices.
VertexRings vertex_rings(const TriMesh& mesh);

/// The same smoothing with rings found before; visits only `movable`, in its order. Allocates nothing. The options
/// must have been checked.
SmoothReport smooth(std::span<Vec3> vertices, const VertexRings& rings, std::span<const std::uint32_t> movable,
                    const Smoothing& options, double smallest_spacing_mm);

/// 2 pi minus the sum of the angles at each vertex (thesis 5.2, 5.3): positive on a peak or a pit, negative on a
/// saddle, 0 for vertices without a ring.
std::vector<double> angle_deficits(const TriMesh& mesh);

}  // namespace dynasurf::mesh
