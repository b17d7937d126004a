#pragma once
#include <optional>

#include "dynasurf/mesh/tetrahedra.hpp"
#include "dynasurf/ventricle/measures/detail/heart_axes.hpp"

namespace dynasurf::ventricle {

/// How finely a wall is filled.
struct WallSolidSize {
  int rings = 24;    // from apex to base
  int sectors = 64;  // around
  int layers = 3;    // through the wall
};

/// The wall of one gate as tetrahedra (FUT-TETRA, thesis 5.2 and 6.1.6.2).
struct WallSolid {
  mesh::TetMesh mesh;      // world, mm; the same tetrahedra for every gate and study of one size
  double volume_ml = 0;    // of the tetrahedra, each larger than 0 unless `quality.not_positive` says so
  double surfaces_ml = 0;  // between the closed surfaces they fill, as far as they lie below the valve plane
  double moved_mm = 0;     // how far its surfaces were moved along the rays to hold the volumes of those they sample
  double lowered_mm = 0;   // how far below the valve plane it ends, because the surfaces do
  mesh::TetQuality quality;
  std::vector<int> ring;   // of every vertex: 0 apex to `rings` base
  std::vector<int> layer;  // of every vertex: 0 endocardium to `layers` epicardium
};

/// Fills the wall along the rays of `axes`: both surfaces are met at the same polar points, so that they have the same
/// triangles, and the space between them is cut up. Flat triangles between points of a round surface hold less than it
/// does, so each side is moved along the rays, everywhere alike, until it holds what its surface does: the tetrahedra
/// add up to the wall. The base is cut by the valve plane, or up to 12 mm below it where the surfaces end before it.
/// Absent where a ray misses a surface or meets the endocardium outside the epicardium, or a side would have to be
/// moved by more than 1 mm.
std::optional<WallSolid> wall_solid(const TriMesh& endo, const TriMesh& epi, const HeartAxes& axes,
                                    const WallSolidSize& size = {});

}  // namespace dynasurf::ventricle
