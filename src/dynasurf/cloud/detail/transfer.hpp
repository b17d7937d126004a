#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// Colours of the points, carried over to the vertices of a mesh: the mean, in linear light, of the points nearest to
/// each vertex, as many as there are points per vertex (1 to 64), so that coarse levels are not speckled. One per
/// vertex; empty when the cloud has no colours. The same for any number of threads. `neighbours` are those of the
/// cloud's points.
std::vector<std::array<std::uint8_t, 3>> colours_at_vertices(const TriMesh& mesh, const PointCloud& cloud,
                                                             const KdTree& neighbours);

}  // namespace dynasurf::cloud
