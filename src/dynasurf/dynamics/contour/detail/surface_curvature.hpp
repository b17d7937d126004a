#pragma once
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/dynamics/particles.hpp"

namespace dynasurf::dynamics {

/// The discrete contour's internal force carried to surfaces (FUT-3DCONTOUR, thesis 7.3): the vertex curvature minus
/// its mean over the ring of neighbours, along the vertex normal, so that a surface of constant curvature feels
/// nothing, whatever its size, and a bump is pulled back.
///
/// The curvature of a vertex is the mean of that of its edges, 2 n.(x - x_j) / |x - x_j|^2, with the normal n of the
/// vertex: exactly 1/R on a sphere with radial normals (negative inwards of a pit). It is made free of size by the
/// mean edge length, like the angle of a contour. 0 at vertices of a boundary or without triangles.
/// Normals are means of those of the triangles, weighted by the angle at the vertex.
std::vector<Vec3> surface_curvature_force(const TriMesh& mesh);

/// The same, times `strength` (kg mm/s2), on particles that are the vertices of `mesh`. Its jacobian is not the slope
/// but a bound of it.
Force surface_curvature_force(const TriMesh& mesh, double strength);

/// Mean curvature per vertex as above, 1/mm, positive where convex.
std::vector<double> vertex_curvatures(const TriMesh& mesh);

}  // namespace dynasurf::dynamics
