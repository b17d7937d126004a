#pragma once
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/mesh/detail/textured_mesh.hpp"

namespace dynasurf::cloud {

/// What a coarse level lacks, as textures: the directions of the points' normals, and their colours where they have
/// any. Every triangle has half a square of its own, with room around it for filtering, as large as the points on it
/// are dense (8 to 40 texels). A texel takes the mean of the points nearest to its place whose normal does not turn
/// away from the surface there; without any, the normal of the surface. The points' normals must be oriented, one for
/// each; `orient` finds them. The same for any number of threads. Throws InputError for a mesh without triangles or a
/// cloud without normals.
mesh::TexturedMesh bake_textures(const TriMesh& mesh, const PointCloud& cloud);

}  // namespace dynasurf::cloud
