#pragma once
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::mesh {

/// Part of each voxel (0..1) inside a closed, oriented mesh given in the grid frame. Exact along k; sampled at
/// `sub_samples[0]` x `sub_samples[1]` columns per voxel across. Throws InputError when a column crosses the mesh an
/// odd number of times, as it does above a hole.
Image fill_mesh(const Grid& grid, const TriMesh& mesh, const Index3& sub_samples);

}  // namespace dynasurf::mesh
