#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/image/detail/gaussian.hpp"
#include "dynasurf/image/detail/ridges.hpp"
#include "dynasurf/image/edges.hpp"

namespace dynasurf::image {

std::span<const std::string_view> names_of(CannyThreshold) {
  static constexpr std::array<std::string_view, 3> names{"max_fraction", "max_fraction_slice", "percentile"};
  return names;
}

namespace {

/// One slice on its way from values to edges.
struct Work {
  SliceVectors gradient;
  Slice magnitude, ridges;
};

Work find_ridges(const Image& image, int k, const std::vector<double>& half_kernel) {
  Slice slice = slice_of(image, k);
  smooth(slice, half_kernel);
  Work w{central_gradient(slice), {}, {}};
  w.magnitude = lengths_of(w.gradient);
  w.ridges = thin(w.magnitude, w.gradient);
  return w;
}

struct Thresholds {
  float low, high;
};

Thresholds share_of(float max, const Canny& o) {
  const float low = o.low * max, high = o.high * max;
  return {low, high};
}

/// Value below which a share `q` of the non-zero values lies; 0 when there are none.
float quantile_of_nonzero(const std::vector<Work>& work, double q) {
  std::vector<float> values;
  for (const Work& w : work)
    std::copy_if(w.ridges.values.begin(), w.ridges.values.end(), std::back_inserter(values),
                 [](float v) { return v != 0; });
  return quantile(std::move(values), q);
}

Thresholds common_thresholds(const std::vector<Work>& work, const Image& gradient, const Canny& o) {
  if (o.threshold != CannyThreshold::percentile) return share_of(largest_of(gradient), o);
  const float high = quantile_of_nonzero(work, o.high);
  const float low = o.low * high;
  return {low, high};
}

/// The four grid directions of which a minor edge is a maximum along at least one.
constexpr std::array<std::array<int, 2>, 4> grid_directions{{{1, 0}, {1, 1}, {0, 1}, {-1, 1}}};

bool is_maximum_along(const Slice& m, int i, int j, const std::array<int, 2>& d) {
  return m(i, j) > m.clamped(i + d[0], j + d[1]) && m(i, j) > m.clamped(i - d[0], j - d[1]);
}

bool is_minor(const Work& w, int i, int j, float low) {
  const float m = w.magnitude(i, j);
  if (!(m > 0 && m >= low) || w.ridges(i, j) > 0) return false;
  return std::any_of(grid_directions.begin(), grid_directions.end(),
                     [&](const auto& d) { return is_maximum_along(w.magnitude, i, j, d); });
}

/// The edge each pixel of a slice belongs to, 0: none.
std::vector<int> number_edges(const Mask& edges, int k, int width, int height) {
  std::vector<int> number(size_of({width, height, 1}), 0);
  const auto at = [&](int i, int j) { return index_in({width, height, 1}, {i, j, 0}); };
  int last = 0;
  std::vector<std::pair<int, int>> stack;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      if (!edges(i, j, k) || number[at(i, j)]) continue;
      number[at(i, j)] = ++last;
      stack.emplace_back(i, j);
      while (!stack.empty()) {
        const auto [ci, cj] = stack.back();
        stack.pop_back();
        for (int b = std::max(0, cj - 1); b <= std::min(height - 1, cj + 1); ++b)
          for (int a = std::max(0, ci - 1); a <= std::min(width - 1, ci + 1); ++a)
            if (edges(a, b, k) && !number[at(a, b)]) number[at(a, b)] = last, stack.emplace_back(a, b);
      }
    }
  return number;
}

/// Adds the chains of minor pixels that touch a major edge and lead somewhere: to another edge, or away from it. A
/// slanted edge is accompanied by minor pixels that do neither; they would only thicken it.
void add_minor_edges(const Work& w, float low, Mask& edges, int k) {
  const int width = w.magnitude.width, height = w.magnitude.height;
  const std::vector<int> number = number_edges(edges, k, width, height);
  const auto at = [&](int i, int j) { return index_in({width, height, 1}, {i, j, 0}); };
  std::vector<std::uint8_t> open(number.size(), 0);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) open[at(i, j)] = is_minor(w, i, j, low);

  std::vector<std::pair<int, int>> chain;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      if (!open[at(i, j)]) continue;
      chain.assign(1, {i, j});
      open[at(i, j)] = 0;
      int first = 0;
      bool touches_two = false, leads_away = false;
      for (std::size_t n = 0; n < chain.size(); ++n) {
        const auto [ci, cj] = chain[n];
        bool touches = false;
        for (int b = std::max(0, cj - 1); b <= std::min(height - 1, cj + 1); ++b)
          for (int a = std::max(0, ci - 1); a <= std::min(width - 1, ci + 1); ++a) {
            if (const int edge = number[at(a, b)]) {
              touches = true;
              touches_two |= first != 0 && first != edge;
              first = edge;
            }
            if (open[at(a, b)]) open[at(a, b)] = 0, chain.emplace_back(a, b);
          }
        leads_away |= !touches;
      }
      if (first != 0 && (touches_two || leads_away))
        for (const auto& [ci, cj] : chain) edges(ci, cj, k) = minor_edge;
    }
}

/// Minor pixels are no ridges across their gradient; theirs is the grid direction along which they stand out most.
void put_minor_offsets(const Work& w, EdgeMap& map, int k) {
  const Slice& m = w.magnitude;
  const auto drop = [&](int i, int j, const std::array<int, 2>& d) {
    return is_maximum_along(m, i, j, d) ? 2 * m(i, j) - (m.clamped(i + d[0], j + d[1]) + m.clamped(i - d[0], j - d[1]))
                                        : 0;
  };
  for (int j = 0; j < m.height; ++j)
    for (int i = 0; i < m.width; ++i) {
      if (map.edges(i, j, k) != minor_edge) continue;
      const auto& d = *std::max_element(grid_directions.begin(), grid_directions.end(),
                                        [&](const auto& a, const auto& b) { return drop(i, j, a) < drop(i, j, b); });
      const RidgeOffset o = ridge_offset(m, i, j, d[0], d[1]);
      map.offsets->x_px(i, j, k) = o.x;
      map.offsets->y_px(i, j, k) = o.y;
    }
}

EdgeMap detect(const Image& image, const Canny& o, bool with_minor) {
  Canny checked = o;
  check_options(checked, "canny");
  require_order(o.low, o.high, "canny");
  require_finite(image);

  EdgeMap map{Mask(image.grid), Image(image.grid), {}, {}};
  std::vector<Work> work(std::max(0, image.grid.dims[2]));
  const std::vector<double> half_kernel = half_gaussian(o.sigma_px);
  for_each_slice(image.grid, [&](int k) {
    Work& w = work[k] = find_ridges(image, k, half_kernel);
    put_slice(w.magnitude, map.gradient, k);
  });

  if (o.subpixel) map.offsets = EdgeOffsets{Image(image.grid), Image(image.grid)};
  const Thresholds common = common_thresholds(work, map.gradient, o);
  for_each_slice(image.grid, [&](int k) {
    const Work& w = work[k];
    const auto& m = w.magnitude.values;
    const bool own = o.threshold == CannyThreshold::max_fraction_slice && !m.empty();
    const Thresholds t = own ? share_of(*std::max_element(m.begin(), m.end()), o) : common;
    trace(w.ridges, t.low, t.high, map.edges, k);
    if (with_minor) add_minor_edges(w, t.low, map.edges, k);
    if (!o.subpixel) return;
    put_offsets(w.magnitude, w.gradient, map, k);
    if (with_minor) put_minor_offsets(w, map, k);
  });
  note_flat(map);
  return map;
}

}  // namespace

EdgeMap detect_edges(const Image& image, const Canny& options) { return detect(image, options, false); }

EdgeMap detect_edges(const Image& image, const CannyRevised& options) { return detect(image, options.canny, true); }

}  // namespace dynasurf::image
