#pragma once
#include <span>
#include <vector>

#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/detail/surface_editor.hpp"

namespace dynasurf::mesh {

/// Flips edges while the smallest angle of their two triangles grows and the surface keeps its shape: neither pair of
/// triangles is bent by more than `largest_bend_deg`, or the new pair is bent less than the old one. Refuses flips
/// after which the surface would meet itself. Returns how many were flipped.
int flip_to_larger_angles(SurfaceEditor& surface, double largest_bend_deg, int sweeps = 5);

/// Moves vertices within the surface towards the middle of their neighbours, where triangles are weighted by the size
/// that is asked for around them (`sizes`: the wanted edge length of each vertex slot), and back onto `onto`. No
/// normal turns by more than 60 degrees in a step, and the smallest angle around a vertex may shrink only while it is
/// above `enough_deg`. Where the normals around a vertex differ by more than `sharp_deg`, it moves only along the edge
/// that they show, and not at all on a corner; 180: everywhere freely.
void relax(SurfaceEditor& surface, std::span<const double> sizes, const ClosestPoint& onto, const TriMesh& onto_mesh,
           int sweeps, double enough_deg, double sharp_deg = 180);

/// Mean edge length at each vertex slot, evened out over `sweeps` rings of neighbours.
std::vector<double> local_sizes(const SurfaceEditor& surface, int sweeps);

/// Changes the surface where triangles have an angle below `wanted_deg`: flips, moves of the corners, and collapses
/// of short edges paid back by splits of the longest ones, so the number of triangles stays. Never makes the surface
/// meet itself. In the first half of the rounds vertices stay on edges and corners as in `relax`. Returns the smallest
/// angle left, degrees.
double improve_smallest_angle(SurfaceEditor& surface, double wanted_deg, int rounds, double sharp_deg = 180);

/// Takes vertices back to `safe`, where the surface is free of self-intersections, until it is so again: those of the
/// triangles that meet first, then their neighbours. Returns how many went back.
std::size_t revert_self_intersections(SurfaceEditor& surface, std::span<const Vec3> safe);

}  // namespace dynasurf::mesh
