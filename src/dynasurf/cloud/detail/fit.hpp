#pragma once
#include <span>

#include "dynasurf/mesh/detail/surface_editor.hpp"

namespace dynasurf::cloud {

/// What a surface is fitted to. `normals` is empty or has one unit normal per point; a point is then not drawn to a
/// side of the surface that faces away from it.
struct FitPoints {
  std::span<const Vec3> points, normals;
};

struct FitOptions {
  int rounds = 2;                  // nearest points are found anew in each
  double hold = 0.02;              // against moves that differ from those of the neighbours
  double smoothness = 1e-3;        // against bends that change along the surface; it rules where there are no points
  double smallest_angle_deg = 20;  // no angle falls below it that is not below it already
  double largest_turn_deg = 60;    // of a normal in a round
  int iterations = 40;             // of conjugate gradients in a round
  double noise = 0;                // of the points: what lies twice as far off counts less
};

/// Moves the vertices so that the mean distance of the points to the surface becomes small: in each round every point
/// is tied to the nearest place of the surface, across it firmly and along it loosely, and the sum of squares, weighted
/// towards distances (which makes it robust), is solved for all vertices at once. Moves that would spoil a triangle are
/// shortened, and those that would make the surface meet itself are taken back. The surface must be free of
/// self-intersections. Returns the mean distance of the points before the last round.
double fit(mesh::SurfaceEditor& surface, const FitPoints& to, const FitOptions& options);

/// The mean distance of points to a surface.
double mean_distance(const mesh::SurfaceEditor& surface, std::span<const Vec3> points);

}  // namespace dynasurf::cloud
