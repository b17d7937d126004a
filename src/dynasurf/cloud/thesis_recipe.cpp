#include "dynasurf/cloud/detail/thesis_recipe.hpp"

#include <algorithm>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"

namespace dynasurf::cloud {
namespace {

int level_of(int triangles) {
  for (int level = 0, count = 20; level <= 9; ++level, count *= 4)
    if (count == triangles) return level;
  throw OptionError("option triangles: method thesis makes icospheres of 20 times a power of 4 triangles, not of " +
                    std::to_string(triangles));
}

/// The values of GEN-FIT.
dynamics::Evolution recipe() {
  dynamics::Evolution o = dynamics::free_model();
  o.force.strength = 0.1;
  o.force.drag = 0;
  o.step_s = 0.001;
  o.end.still_move = 0;  // they start from rest, and slowly: only the border or the last step ends a run
  o.smooth_every = 0;
  o.smooth_after.sweeps = 0;
  return o;
}

void note_arrival(const dynamics::EvolutionResult& evolved, int triangles, Notes& notes) {
  const auto left = std::count(evolved.stopped.begin(), evolved.stopped.end(), std::uint8_t{0});
  if (left > 0)
    notes.push_back({Severity::warning, "cloud.not_arrived",
                     std::to_string(left) + " of " + std::to_string(evolved.stopped.size()) +
                         " particles of the mesh of " + std::to_string(triangles) +
                         " triangles never met a border voxel"});
}

}  // namespace

CloudVoxels voxelise(std::span<const Vec3> points, int cells, int margin) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  CloudVoxels v;
  // GEN-VOXEL: cubic voxels, so that the body keeps its shape, and empty ones around it for the field.
  v.side = box.sizes().maxCoeff() / (cells - 2 * margin);
  v.origin = box.center() - Vec3::Constant(0.5 * (cells - 1) * v.side);
  v.border = Image(Grid{.dims = {cells, cells, cells}});
  for (const Vec3& p : points) {
    const Index3 at = voxel_of(v.border.grid, Vec3((p - v.origin) / v.side));
    // The points of the two outermost faces lie exactly between two voxels.
    v.border(std::clamp(at[0], margin, cells - margin - 1), std::clamp(at[1], margin, cells - margin - 1),
             std::clamp(at[2], margin, cells - margin - 1)) = 1;
  }
  return v;
}

mesh::Placement placement_of(CloudStart start) {
  mesh::Placement place{.scale = 1.15};
  if (start == CloudStart::sphere) place.shape = mesh::StartShape::sphere;
  if (start == CloudStart::field) place.shape = mesh::StartShape::marching_cubes;
  if (start == CloudStart::hull) place = {.shape = mesh::StartShape::hull, .scale = 1.02};
  return place;
}

std::vector<TriMesh> thesis_meshes(std::span<const Vec3> points, std::span<const int> triangles, CloudStart start,
                                   Notes& notes, const Progress& progress) {
  const Progress quiet{{}, progress.stop};
  std::vector<int> levels;
  for (const int count : triangles) levels.push_back(level_of(count));
  const CloudVoxels voxels = voxelise(points);
  progress("inside", 0, 1);
  // GEN-GVF.
  const field::FlowResult flow = field::flow_field(voxels.border, field::Gvf{.mu = 2, .iterations = 200}, quiet);
  progress("inside", 1, 1);
  notes.insert(notes.end(), flow.notes.begin(), flow.notes.end());
  std::vector<TriMesh> meshes;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    progress("levels", i, levels.size());
    const dynamics::EvolutionResult evolved = dynamics::evolve(
        mesh::start_mesh(voxels.border, levels[i], placement_of(start)), flow.field, voxels.border, recipe(), quiet);
    note_arrival(evolved, triangles[i], notes);
    meshes.push_back(evolved.mesh);
    for (Vec3& p : meshes.back().vertices) p = voxels.origin + voxels.side * p;
  }
  progress("levels", levels.size(), levels.size());
  return meshes;
}

}  // namespace dynasurf::cloud
