#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::field {

/// One vector per voxel, in components, 1/mm, along the axes of the grid frame.
struct VectorField {
  Grid grid;
  std::vector<float> x, y, z;

  VectorField() = default;
  explicit VectorField(const Grid& g) : grid(g), x(g.size()), y(g.size()), z(g.size()) {}
};

/// How a field is read between voxel centres (FLD-SAMPLE, thesis 6.1.2.1). Outside the grid: the nearest voxel.
enum class Sampling { nearest, trilinear, neighbour };
std::span<const std::string_view> names_of(Sampling);

/// Field at a point of the grid frame. `neighbour` averages the 2x2x2 block that lies in the direction of `velocity`
/// (thesis); the other two ignore it.
Vec3 sample(const VectorField& field, const Vec3& grid_mm, Sampling how, const Vec3& velocity = Vec3::Zero());

}  // namespace dynasurf::field
