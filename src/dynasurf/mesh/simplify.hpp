#pragma once
#include <cstddef>

#include "dynasurf/mesh/detail/surface_editor.hpp"

namespace dynasurf::mesh {

/// Sine of the triangle's smallest angle; 0 for a flat one.
double sine_of_smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c);

/// How a surface loses triangles. Lengths do not enter, so the unit is free.
struct Simplify {
  std::size_t triangles = 1000;    // how many are to be left
  double evenness = 1e-4;          // against the distance: 0 puts triangles only where the shape asks for them
  double smallest_angle_deg = 20;  // collapses that make a smaller one wait until there are no others
  double largest_turn_deg = 60;    // no triangle's normal turns by more in one collapse
  bool exact = true;               // collapses that would make the surface meet itself are refused
};

/// Collapses edges, the one that moves the surface least first (quadrics of Garland and Heckbert 1997, of the planes of
/// the surface as it comes; a boundary keeps its course by planes that stand on it), until `triangles` are left or none
/// can go. Returns how many are left.
std::size_t simplify(SurfaceEditor& surface, const Simplify& options);

/// Splits edges in their middle, the longest first, until there are `triangles` (or one more, where that is odd).
void refine(SurfaceEditor& surface, std::size_t triangles);

}  // namespace dynasurf::mesh
