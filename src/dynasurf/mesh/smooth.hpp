#pragma once
#include <cstdint>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf {

/// The thesis's smoothing by angle deficit (GEO-SMOOTH, thesis 5.5).
struct Smoothing {
  double tolerance_rad = 0.2;
  double step_mm = 0;
  bool literal_step = false;
  int sweeps = 1;
};
void describe(auto& visit, Smoothing& o) {
  visit("tolerance_rad", o.tolerance_rad,
        Field{"a vertex is a peak when its angles miss 2 pi by more (thesis 5.3)", "rad", 0, 6.3});
  visit("step_mm", o.step_mm,
        Field{"length of one move towards the neighbours' centroid; 0: smallest voxel side / 20", "mm", 0, 100});
  visit("literal_step", o.literal_step,
        Field{"read the thesis literally: the step is a share of the way, not a length"});
  visit("sweeps", o.sweeps, Field{"passes over the vertices; 0 does nothing", "", 0, 10000});
}

struct SmoothReport {
  int moved = 0;        // vertices moved in the last sweep
  int at_centroid = 0;  // of them, those that ended in the centroid with a peak left
};

/// Moves peaks towards the centroid of their ring, in place, in vertex order. Boundary vertices and those with
/// `pinned[v] != 0` stay (`pinned` may be empty). Never changes the topology. `smallest_spacing_mm` gives the step
/// when `step_mm` is 0.
SmoothReport smooth(TriMesh& mesh, const Smoothing& options, double smallest_spacing_mm,
                    const std::vector<std::uint8_t>& pinned = {});

}  // namespace dynasurf
