#pragma once
#include <optional>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/heart/detail/lv_shell.hpp"

namespace dynasurf::psf_fit {

/// A place through which a person says that a wall goes. World frame.
struct WallPoint {
  int gate = 0;
  bool is_outer = false;
  Vec3 place{0, 0, 0};
};

/// What a fit begins with: both surfaces of every gate, where the ventricle ends, and its long axis. World frame.
/// With a `cup`, the middle of the wall as it was located, walls of even thickness around it take the place of the
/// surfaces, which may be empty then: an edge that a defect or a neighbour led astray leads no fit astray.
struct FitStart {
  std::vector<TriMesh> endo, epi;                     // one per gate
  std::vector<std::optional<heart::BasePlane>> base;  // one per gate; absent: where the surfaces end
  Vec3 axis{0, 0, 1};                                 // from apex to base, any length but 0
  Vec3 lateral{1, 0, 0};                              // direction of the heart's x, not along the axis
  std::optional<heart::LvShell> cup;
  double base_shift_mm = 0;                     // a person moves the fitted planes by this along `axis`
  std::optional<heart::BasePlane> placed_base;  // where a person says that the ventricle ends, in all gates
  std::optional<Mask> looked_at;                // on the study's grid; absent: all of it
  std::vector<WallPoint> points;                // that a person placed
  std::vector<double> edge_ml;                  // volume within the inner edges of each gate; none: not to be used
};

}  // namespace dynasurf::psf_fit
