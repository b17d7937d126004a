#pragma once
#include <span>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// The smallest convex surface around points (quickhull: Barber, Dobkin and Huhdanpaa 1996), decided by exact
/// predicates: closed, manifold, oriented outwards, of genus 0, without flat triangles, and no point lies outside it.
/// Its vertices are points of the input, each once; flat faces of more than three corners are cut into triangles, which
/// may have corners within the face. The same triangles for the same points in the same order.
/// Throws InputError for a point that is not finite, or points that all lie in one plane.
TriMesh convex_hull(std::span<const Vec3> points);

/// A convex hull with about `triangles` even triangles, at least 20: a surface to start from. Throws like
/// `convex_hull`.
TriMesh even_hull(std::span<const Vec3> points, std::size_t triangles);

}  // namespace dynasurf::mesh
