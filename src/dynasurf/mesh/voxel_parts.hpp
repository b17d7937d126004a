#pragma once
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::mesh {

/// Part of each voxel (0..1) inside a closed, oriented mesh given in the grid frame: exact but for rounding, whatever
/// the size of triangles and voxels, so the parts of a mesh inside the grid add up to its volume. Where the mesh cuts
/// itself a part counts as often as the surface winds around it, at most once. Throws InputError when the mesh is open
/// or its triangles do not all face the same way.
Image voxel_parts(const Grid& grid, const TriMesh& mesh);

}  // namespace dynasurf::mesh
