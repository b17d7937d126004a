#pragma once
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::synthetic {

/// PH-TERRAIN: a height field of hills with single spikes on them, which smoothing is to take down (thesis 5.5.7, fig.
/// 5.16).
struct Terrain {
  int cells = 40;
  double cell_mm = 1;
  double hill_mm = 4;
  double spike_mm = 5;
  int spike_every = 61;
};
void describe(auto& visit, Terrain& o) {
  visit("cells", o.cells, OptionInfo{"squares along each side", "", 2, 1000});
  visit("cell_mm", o.cell_mm, OptionInfo{"side of a square", "mm", 1e-3, 1000});
  visit("hill_mm", o.hill_mm, OptionInfo{"height of the hills", "mm", 0, 1e4});
  visit("spike_mm", o.spike_mm, OptionInfo{"height of a spike above its hill", "mm", 0, 1e4});
  visit("spike_every", o.spike_every, OptionInfo{"one vertex in so many has a spike; 0: none", "", 0, 1000000});
}

/// Height of the hills at a place, without spikes, mm.
double hill_height_mm(const Terrain& options, double x_mm, double y_mm);

/// The open surface of cells^2 squares of two triangles each, seen from above counter-clockwise; vertices row by row.
/// The rim has no spikes. Throws OptionError.
TriMesh make_terrain(const Terrain& options);

}  // namespace dynasurf::synthetic
