#pragma once
#include <cstdint>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// What a published surface must be.
struct SurfaceCheck {
  bool closed = false;                 // every edge has two triangles or more
  bool manifold = false;               // no edge has more than two, and the triangles of every vertex form one fan
  bool oriented = false;               // neighbouring triangles run through their common edge in opposite directions
  std::size_t self_intersections = 0;  // pairs of triangles that meet
  std::size_t flat_triangles = 0;      // corners exactly on one line
  bool valid() const { return closed && manifold && oriented && self_intersections == 0 && flat_triangles == 0; }
};

/// Exact, see `self_intersections`. An empty mesh is no surface: not closed. Throws like it.
SurfaceCheck check_surface(const TriMesh& mesh);

/// Better triangles on the same surface.
struct Tidy {
  double shape = 0.3;
  int sweeps = 10;
  int untangle_rounds = 40;
};
void describe(auto& visit, Tidy& o) {
  visit("shape", o.shape,
        OptionInfo{
            "vertices with a worse triangle move within the surface until it has this shape (1: equilateral, 0: flat); "
            "0 moves none",
            "", 0, 1});
  visit("sweeps", o.sweeps, OptionInfo{"passes over the vertices at most", "", 0, 1000});
  visit("untangle_rounds", o.untangle_rounds,
        OptionInfo{"attempts to free the surface of triangles that cut each other; 0 leaves them", "", 0, 1000});
}

/// Who was moved, and how far.
struct MoveReport {
  std::size_t vertices_moved = 0;
  double largest_move_mm = 0;
  double volume_change_mm3 = 0;
};

/// Moves the vertices of ill-shaped triangles across their normal, that is within the surface, towards the middle of
/// their neighbours, as far as the worst triangle around them improves and no normal turns by more than 60 degrees.
/// The direction is that in which the enclosed volume does not change at all; only where a fan has no normal a vertex
/// moves freely. Vertices of the boundary and of several fans stay. Never changes the triangles' corners. In place and
/// in vertex order.
MoveReport tidy(TriMesh& mesh, const Tidy& options);

/// What `untangle` did.
struct UntangleReport : MoveReport {
  int rounds = 0;
  std::size_t found = 0;  // pairs that met and flat triangles before
  std::size_t left = 0;   // and after
};

/// Frees a surface of self-intersections: the neighbourhood of triangles that meet is smoothed towards the mean of its
/// neighbours, and grows where that is not enough. Triangles keep their corners; what meets nothing stays where it is.
/// With `rounds` spent, or eight of them without gain, the surface is given back as it was, with `left` equal to
/// `found`. Throws like
/// `self_intersections`.
UntangleReport untangle(TriMesh& mesh, int rounds);

/// What was done to a surface before it may be published, and what it is then.
struct Repair {
  MoveReport tidied;
  UntangleReport untangled;
  SurfaceCheck check;
};

/// `tidy`, `untangle`, `check_surface`, at the cost of one search for intersections where there are none.
Repair repair_surface(TriMesh& mesh, const Tidy& options);

}  // namespace dynasurf::mesh
