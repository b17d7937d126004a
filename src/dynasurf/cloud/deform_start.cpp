#include "dynasurf/cloud/detail/deform_start.hpp"

#include <algorithm>

#include "dynasurf/cloud/detail/thesis_recipe.hpp"
#include "dynasurf/field/steady.hpp"
#include "dynasurf/field/vector_field.hpp"
#include "dynasurf/mesh/detail/relax.hpp"
#include "dynasurf/mesh/detail/sample_surface.hpp"
#include "dynasurf/mesh/detail/submesh.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/simplify.hpp"

namespace dynasurf::cloud {
namespace {

/// What draws particles: the border voxels of a surface, and the field that leads to them.
struct Pull {
  CloudVoxels voxels;
  field::VectorField field;
};

Pull pull_of(const TriMesh& target, const Progress& progress) {
  constexpr std::size_t samples = 60000;  // several for each voxel that the surface passes
  std::vector<Vec3> points;
  for (const mesh::SurfaceSample& s : mesh::sample_surface(target, samples))
    points.push_back(mesh::position_of(target, s));
  Pull pull{voxelise(points), {}};
  pull.field = field::flow_field(pull.voxels.border, field::SteadyGvf{}, progress).field;
  return pull;
}

/// One step of all particles that have not met the border.
void follow(mesh::SurfaceEditor& surface, const Pull& pull) {
  constexpr double step = 0.4;  // voxels: a border of one voxel is not stepped over
  const Image& border = pull.voxels.border;
  const std::vector<Vec3> safe(surface.positions().begin(), surface.positions().end());
  for (std::uint32_t v = 0; v < surface.vertex_slots(); ++v) {
    if (!surface.has_vertex(v)) continue;
    Vec3& p = surface.position(v);
    Index3 at = voxel_of(border.grid, p);
    for (std::size_t a = 0; a < 3; ++a) at[a] = std::clamp(at[a], 0, border.grid.dims[a] - 1);
    if (border(at[0], at[1], at[2]) != 0) continue;
    const Vec3 way = field::sample(pull.field, p, field::Sampling::trilinear);
    if (way.norm() > 0) p += step * way.normalized();
  }
  mesh::revert_self_intersections(surface, safe);
}

/// Triangles of even size and shape on the surface as it stands.
void even_out(mesh::SurfaceEditor& surface, std::size_t triangles) {
  mesh::refine(surface, triangles + triangles / 2);
  mesh::simplify(surface, {.triangles = triangles, .evenness = 0.05});
  mesh::flip_to_larger_angles(surface, 30);
  const std::vector<Vec3> safe(surface.positions().begin(), surface.positions().end());
  const TriMesh shape = surface.mesh();
  const mesh::ClosestPoint on_shape(shape);
  mesh::relax(surface, std::vector<double>(surface.vertex_slots(), 1), on_shape, shape, 2, 30);
  mesh::revert_self_intersections(surface, safe);
}

TriMesh deform_part(const TriMesh& target, CloudStart start, const Progress& progress) {
  constexpr struct { int level, steps; } passes[] = {{3, 100}, {4, 40}};
  constexpr int evened_every = 10;
  const Pull pull = pull_of(target, {{}, progress.stop});
  mesh::SurfaceEditor surface(mesh::start_mesh(pull.voxels.border, passes[0].level, placement_of(start)));
  std::vector<TriMesh> states;
  for (const auto& [level, steps] : passes) {
    const std::size_t triangles = std::size_t{20} << 2 * level;
    for (int k = 0; k < steps; ++k) {
      progress.check();
      if (k % evened_every == 0) {
        even_out(surface, triangles);
        states.push_back(surface.mesh());
      }
      follow(surface, pull);
    }
  }
  states.push_back(surface.mesh());
  // Sheets that all but touch may cross once they are rounded to the cloud's frame: a state shortly before does not.
  for (;;) {
    TriMesh mesh = std::move(states.back());
    states.pop_back();
    for (Vec3& p : mesh.vertices) p = pull.voxels.origin + pull.voxels.side * p;
    if (states.empty() || mesh::self_intersections(mesh).free()) return mesh;
  }
}

}  // namespace

TriMesh deform_start(const TriMesh& target, CloudStart start, const Progress& progress) {
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> part = mesh::components_of(target, count);
  TriMesh all;
  std::vector<std::uint8_t> marks(part.size());
  for (std::uint32_t n = 0; n < count; ++n) {
    std::transform(part.begin(), part.end(), marks.begin(), [n](std::uint32_t p) { return p == n; });
    const TriMesh mesh = deform_part(mesh::submesh(target, marks), start, progress);
    const std::uint32_t first = all.vertices.size();
    all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& [a, b, c] : mesh.triangles) all.triangles.push_back({first + a, first + b, first + c});
  }
  return all;
}

}  // namespace dynasurf::cloud
