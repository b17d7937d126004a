#pragma once
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// Unit normals of the vertices: means of the normals of their triangles weighted by area, outwards for a surface whose
/// triangles run counter-clockwise. With `counts`, only triangles for which it is true take part. A vertex of no such
/// triangle, or of triangles that cancel each other, has a zero vector.
std::vector<Vec3> vertex_normals(const TriMesh& mesh, const std::vector<bool>& counts = {});

/// The same weighted by the angle of each triangle at the vertex: they do not depend on how a flat ring is cut.
std::vector<Vec3> angle_weighted_normals(const TriMesh& mesh);

}  // namespace dynasurf::mesh
