#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/mesh/closest_point.hpp"

namespace dynasurf::cloud {

/// Where a point of a cloud meets a surface.
struct Foot {
  Vec3 place, normal;   // of the surface
  double distance = 0;  // of the point from it; negative inside
};

/// The unit normal of a triangle; 0 of a flat one.
Vec3 normal_of(const TriMesh& mesh, std::uint32_t triangle);

/// The feet of every `step`-th point on the mesh that `closest` answers for. The same for any number of threads.
std::vector<Foot> feet_of(std::span<const Vec3> points, std::size_t step, const TriMesh& mesh,
                          const mesh::ClosestPoint& closest);

}  // namespace dynasurf::cloud
