#include "dynasurf/field/edge_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dynasurf/field/detail/gradient.hpp"
#include "dynasurf/image/detail/gaussian.hpp"

namespace dynasurf::field {
namespace {

constexpr std::array<std::string_view, 3> kOperators{"gradient_squared", "gradient", "intensity"};

Image operate(const Image& image, EdgeOperator of) {
  if (of == EdgeOperator::intensity) return image;
  const Grid& g = image.grid;
  Image map(g);
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        const Vec3 slope = detail::gradient_at(image, i, j, k);
        map(i, j, k) = of == EdgeOperator::gradient ? slope.norm() : slope.squaredNorm();
      }
  return map;
}

}  // namespace

std::span<const std::string_view> names_of(EdgeOperator) { return kOperators; }

Image edge_map_of(const Image& image, const EdgeMapOptions& options) {
  EdgeMapOptions checked = options;
  check_options(checked, "edge_map");
  detail::check_edge_map(image);
  Image smooth = image;
  if (options.sigma_px > 0)
    for (int axis = 0; axis < 3; ++axis)
      smooth = image::convolve_along(smooth, image::half_gaussian(options.sigma_px), axis);
  Image map = operate(smooth, options.of);
  if (map.values.empty()) return map;
  const auto [low, high] = std::minmax_element(map.values.begin(), map.values.end());
  const bool is_constant = *low == *high;
  const float scale = is_constant ? 0 : (options.reversed ? -1 : 1) / std::max(std::abs(*low), std::abs(*high));
  for (float& v : map.values) v *= scale;
  return map;
}

}  // namespace dynasurf::field
