#include "dynasurf/ventricle/surface.hpp"

#include <algorithm>
#include <numeric>

namespace dynasurf {

Surface measure_surface(const EvolutionResult& evolved, const Image& border,
                        const std::optional<BasePlane>& base_plane) {
  Surface s;
  s.stop_reason = evolved.reason;
  s.steps = evolved.steps;
  s.stopped_fraction = evolved.stopped_fraction;
  const auto count = static_cast<double>(evolved.mesh.vertices.size());
  const std::vector<double> voxels = distances_to_border_voxels(evolved.mesh, border);
  s.within_one_voxel =
      static_cast<double>(std::count_if(voxels.begin(), voxels.end(), [](double d) { return d < 1; })) / count;
  const std::vector<double> mm = distances_to_border_mm(evolved.mesh, border);
  s.mean_distance_mm = std::accumulate(mm.begin(), mm.end(), 0.0) / count;
  const TriMesh whole = base_plane ? flatten_above(evolved.mesh, to_grid(border.grid, *base_plane)) : evolved.mesh;
  s.volume_ml = volume_mm3(whole) / 1000;
  s.quality = triangle_quality(whole);
  s.mesh = to_world(border.grid, whole);
  return s;
}

}  // namespace dynasurf
