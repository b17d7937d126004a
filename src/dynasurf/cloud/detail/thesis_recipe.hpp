#pragma once
#include <span>
#include <vector>

#include "dynasurf/cloud/options.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::cloud {

/// A cloud as border voxels of side 1, with the way back: cloud = origin + side * grid frame.
struct CloudVoxels {
  Image border;  // 1 where there is a point
  double side = 1;
  Vec3 origin{0, 0, 0};  // of the centre of voxel (0,0,0)
};

/// GEN-VOXEL (thesis 6.2): cubic voxels, `cells` along each axis, of which `margin` on each side stay empty; the
/// longest side of the cloud fills the others, and the cloud stands in the middle. The points must be finite and not
/// all alike.
CloudVoxels voxelise(std::span<const Vec3> points, int cells = 62, int margin = 4);

/// Where a mesh stands that is to be drawn onto the border voxels of a cloud: half axes 1.15 times those of their box,
/// a hull 1.02 times its own size.
mesh::Placement placement_of(CloudStart start);

/// GEN-GVF and GEN-FIT (thesis 6.2): gradient vector flow with mu 2 and 200 iterations, then for each of `triangles` an
/// icosphere stretched around the voxels, or another `start`, that moves inwards as a free model (RK4, K 0.1, no drag,
/// step 0.001 s, particles stop in border voxels, no smoothing). Meshes are in the cloud's frame.
/// "cloud.not_arrived" tells of particles that never met a border voxel. Throws OptionError unless each count is 20
/// times a power of 4.
std::vector<TriMesh> thesis_meshes(std::span<const Vec3> points, std::span<const int> triangles, CloudStart start,
                                   Notes& notes, const Progress& progress = {});

}  // namespace dynasurf::cloud
