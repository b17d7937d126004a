#include <algorithm>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/detail/relax.hpp"

namespace dynasurf::cloud {

FreeShape free_at_transition(const LodTransition& transition, double t) {
  FreeShape shape;
  shape.mesh = at_transition(transition, t);
  shape.check = mesh::check_surface(shape.mesh);
  shape.met = shape.check.self_intersections + shape.check.flat_triangles;
  if (shape.met == 0 || t <= 0) return shape;
  try {
    mesh::SurfaceEditor surface(shape.mesh, mesh::SurfaceEditor::Boundary::kept);
    std::vector<Vec3> safe(surface.positions().begin(), surface.positions().end());
    std::copy(transition.fine.vertices.begin(), transition.fine.vertices.end(), safe.begin());
    shape.ahead = mesh::revert_self_intersections(surface, safe);
    for (std::uint32_t v = 0; v < shape.mesh.vertices.size(); ++v) shape.mesh.vertices[v] = surface.position(v);
  } catch (const InputError&) {  // a mesh that is no manifold stays as it is
    return shape;
  }
  shape.check = mesh::check_surface(shape.mesh);
  return shape;
}

}  // namespace dynasurf::cloud
