#include "dynasurf/ventricle/detail/region.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::ventricle {
namespace {

/// The voxels outside a region in layers from its rim outwards, each touching the layer before by a face.
std::vector<std::vector<Index3>> layers_around(const Mask& region) {
  const Grid& g = region.grid;
  Mask reached = region;
  std::vector<std::vector<Index3>> layers;
  std::vector<Index3> front;
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i)
        if (region(i, j, k)) front.push_back({i, j, k});
  while (!front.empty()) {
    std::vector<Index3> next;
    for (const Index3& v : front)
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          Index3 n = v;
          n[axis] += step;
          if (!g.contains(n[0], n[1], n[2]) || reached(n[0], n[1], n[2])) continue;
          reached(n[0], n[1], n[2]) = 1;
          next.push_back(n);
        }
    if (!next.empty()) layers.push_back(next);
    front = std::move(next);
  }
  return layers;
}

/// Every voxel of a layer takes the mean of those of its 26 neighbours that had a value before the layer.
void continue_outwards(Image& image, const Mask& region, const std::vector<std::vector<Index3>>& layers) {
  const Grid& g = image.grid;
  Mask has = region;
  std::vector<float> values;
  for (const auto& layer : layers) {
    values.clear();
    for (const Index3& v : layer) {
      double sum = 0;
      int count = 0;
      for (int k = std::max(0, v[2] - 1); k <= std::min(g.dims[2] - 1, v[2] + 1); ++k)
        for (int j = std::max(0, v[1] - 1); j <= std::min(g.dims[1] - 1, v[1] + 1); ++j)
          for (int i = std::max(0, v[0] - 1); i <= std::min(g.dims[0] - 1, v[0] + 1); ++i)
            if (has(i, j, k)) sum += image(i, j, k), ++count;
      // The count is never 0: a voxel of a layer touches the layer before.
      values.push_back(sum / count);
    }
    // Set after all were computed: within a layer no voxel depends on another.
    for (std::size_t n = 0; n < layer.size(); ++n) {
      const Index3& v = layer[n];
      image(v[0], v[1], v[2]) = values[n];
      has(v[0], v[1], v[2]) = 1;
    }
  }
}

}  // namespace

Mask region_on(const Image& mask, const Grid& grid) {
  Mask region(grid);
  parallel_for(grid.dims[2], 1, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i) {
          const Index3 v = voxel_of(mask.grid, to_grid(mask.grid, to_world(grid, centre_of(grid, {i, j, k}))));
          region(i, j, k) = mask.grid.contains(v[0], v[1], v[2]) && mask(v[0], v[1], v[2]) > 0;
        }
  });
  return region;
}

Study confine(Study study, const Mask& region) {
  const auto inside = std::count_if(region.values.begin(), region.values.end(), [](auto v) { return v != 0; });
  if (inside == 0) throw InputError("the mask covers no voxel of the study; expected one that lies in the same place");
  const auto layers = layers_around(region);
  parallel_for(study.gates.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) continue_outwards(study.gates[g], region, layers);
  });
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "only the %.1f %% of the volume under the mask were looked at",
                100.0 * inside / region.values.size());
  study.notes.push_back({Severity::info, "region.used", text.data()});
  return study;
}

Study only_label(Study study, int label) {
  bool is_any = false;
  for (Image& gate : study.gates)
    for (float& value : gate.values) {
      const bool is_it = value == label;
      value = is_it ? 1.0F : 0.0F, is_any = is_any || is_it;
    }
  if (!is_any) throw InputError("no voxel has the label " + std::to_string(label));
  return study;
}

void clear_outside(Mask& edges, const Mask& region) {
  for (std::size_t n = 0; n < edges.values.size(); ++n)
    if (region.values[n] == 0) edges.values[n] = 0;
}

}  // namespace dynasurf::ventricle
