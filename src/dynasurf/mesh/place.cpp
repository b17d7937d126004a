#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::mesh {
namespace {

struct Extent {
  Index3 low{}, high{};
  Vec3 mean = Vec3::Zero();  // in voxels
  std::size_t voxels = 0;
};

Extent extent_of_non_zero(const Image& data) {
  Extent e{data.grid.dims, {-1, -1, -1}};
  for (int k = 0; k < data.grid.dims[2]; ++k)
    for (int j = 0; j < data.grid.dims[1]; ++j)
      for (int i = 0; i < data.grid.dims[0]; ++i) {
        if (data(i, j, k) == 0) continue;
        const Index3 v{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          e.low[a] = std::min(e.low[a], v[a]);
          e.high[a] = std::max(e.high[a], v[a]);
        }
        e.mean += Vec3(i, j, k);
        ++e.voxels;
      }
  if (e.voxels > 0) e.mean /= e.voxels;
  return e;
}

}  // namespace

TriMesh place(const TriMesh& unit, const Image& data, const Placement& options) {
  Placement checked = options;
  check_options(checked, "place");
  const Extent e = extent_of_non_zero(data);
  if (e.voxels == 0) throw InputError("place: all voxels of the data are zero; expected a border to surround");

  const Vec3 low(e.low[0], e.low[1], e.low[2]), high(e.high[0], e.high[1], e.high[2]);
  // The box holds whole voxels, so that even a single voxel has an ellipsoid around it.
  const Vec3 half_sides = ((high - low).array() + 1).matrix().cwiseProduct(data.grid.spacing) / 2;
  const Vec3 centre = (options.centre_of_mass ? e.mean : Vec3((low + high) / 2)).cwiseProduct(data.grid.spacing);

  const double scale = options.direction == Direction::in_to_out ? options.inside_scale : options.scale;
  const Vec3 half_axes =
      scale * (options.shape == StartShape::sphere ? Vec3(Vec3::Constant(half_sides.maxCoeff())) : half_sides);
  TriMesh mesh = unit;
  for (Vec3& p : mesh.vertices) p = centre + half_axes.cwiseProduct(p);
  return mesh;
}

}  // namespace dynasurf::mesh
