#include "dynasurf/dynamics/detail/damping.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/border_distance.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr std::size_t kDampingGrain = 4096;

/// drag * (1 + ratio * share(voxel)).
template <class Share>
Image raised(const Grid& grid, double drag, double ratio, Share share) {
  Image map(grid);
  parallel_for(map.values.size(), kDampingGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) map.values[v] = drag * (1 + ratio * share(voxel_in(grid.dims, v)));
  });
  return map;
}

struct MapMaker {
  field::FieldView field;
  const Image& border;
  double drag;
  const ImageOfDrag& image;

  std::optional<Image> operator()(const UniformDrag&) const { return std::nullopt; }
  std::optional<Image> operator()(const IntensityDrag& o) const {
    if (!image) throw OptionError("option damping is intensity; expected an image beside the border, none was given");
    return drag_by_intensity(image(), drag, o.ratio);
  }
  std::optional<Image> operator()(const FieldDrag& o) const { return drag_by_field(field, drag, o.ratio); }
  std::optional<Image> operator()(const BorderDrag& o) const {
    return drag_near_border(border, drag, o.ratio, o.reach_voxels);
  }
};

}  // namespace

Image drag_by_intensity(const Image& image, double drag, double ratio) {
  const auto largest = std::max_element(image.values.begin(), image.values.end());
  const double most = largest == image.values.end() ? 0 : *largest;
  return raised(image.grid, drag, ratio,
                [&](const Index3& at) { return most > 0 ? std::max(0.0, image(at[0], at[1], at[2]) / most) : 0.0; });
}

Image drag_by_field(field::FieldView field, double drag, double ratio) {
  const double most = field.largest();
  return raised(field.grid(), drag, ratio,
                [&](const Index3& at) { return most > 0 ? field.at(at[0], at[1], at[2]).norm() / most : 0.0; });
}

Image drag_near_border(const Image& border, double drag, double ratio, double reach_voxels) {
  const mesh::BorderDistance distance(border);
  const Grid& g = border.grid;
  return raised(g, drag, ratio, [&](const Index3& at) {
    // Beyond 30 reaches nothing is left in a float.
    return own::exp(-distance.voxels(centre_of(g, at), 30 * reach_voxels) / reach_voxels);
  });
}

std::optional<Image> drag_map(const DampingOptions& options, field::FieldView field, const Image& border, double drag,
                              const ImageOfDrag& image) {
  return std::visit(MapMaker{field, border, drag, image}, options);
}

}  // namespace dynasurf::dynamics
