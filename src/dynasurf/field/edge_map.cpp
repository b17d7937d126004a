#include "dynasurf/field/edge_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/detail/gradient.hpp"

namespace dynasurf::field {
namespace {

constexpr std::array<std::string_view, 3> kOperators{"gradient_squared", "gradient", "intensity"};

std::vector<double> gaussian(double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> weight(static_cast<std::size_t>(2 * reach + 1));
  double sum = 0;
  for (int n = -reach; n <= reach; ++n)
    sum += weight[static_cast<std::size_t>(n + reach)] = own::exp(-0.5 * n * n / (sigma * sigma));
  for (double& w : weight) w /= sum;
  return weight;
}

/// Along one axis, with replicated borders.
Image blurred(const Image& image, std::size_t axis, const std::vector<double>& weight) {
  const int reach = static_cast<int>(weight.size() / 2);
  const Grid& g = image.grid;
  Image out(g);
  parallel_for(static_cast<std::size_t>(g.dims[2]), 1, [&](std::size_t slice, std::size_t) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        double sum = 0;
        for (int n = -reach; n <= reach; ++n) {
          Index3 at{i, j, k};
          at[axis] += n;
          sum += weight[static_cast<std::size_t>(n + reach)] * image.clamped(at[0], at[1], at[2]);
        }
        out(i, j, k) = static_cast<float>(sum);
      }
  });
  return out;
}

Image operate(const Image& image, EdgeOperator of) {
  if (of == EdgeOperator::intensity) return image;
  const Grid& g = image.grid;
  Image map(g);
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        const Vec3 slope = detail::gradient_at(image, i, j, k);
        map(i, j, k) = static_cast<float>(of == EdgeOperator::gradient ? slope.norm() : slope.squaredNorm());
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
    for (std::size_t axis = 0; axis < 3; ++axis) smooth = blurred(smooth, axis, gaussian(options.sigma_px));
  Image map = operate(smooth, options.of);
  if (map.values.empty()) return map;
  const auto [low, high] = std::minmax_element(map.values.begin(), map.values.end());
  const bool is_constant = *low == *high;
  const float scale = is_constant ? 0 : (options.reversed ? -1 : 1) / std::max(std::abs(*low), std::abs(*high));
  for (float& v : map.values) v *= scale;
  return map;
}

}  // namespace dynasurf::field
