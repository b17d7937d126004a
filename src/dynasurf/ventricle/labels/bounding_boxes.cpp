#include "dynasurf/ventricle/labels/detail/bounding_boxes.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "dynasurf/ventricle/labels/detail/mlc.hpp"

namespace dynasurf::ventricle {
namespace {

/// A box in pixels from the axis. The default one holds everything.
struct Box {
  double x_low = -std::numeric_limits<double>::infinity(), x_high = -x_low;
  double y_low = x_low, y_high = -x_low;

  bool holds(double x, double y) const {
    // Pixels minus axis are not exact; the slack keeps a pixel inside its own box.
    constexpr double rounding = 1e-6;
    return x >= x_low - rounding && x <= x_high + rounding && y >= y_low - rounding && y <= y_high + rounding;
  }
};

struct Filter {
  Mask& borders;
  const Axis& axis;
  double margin_px, least_coverage_deg;
  std::size_t removed = 0;

  void remove_outside(const Box& box, int k, std::uint8_t bit) {
    for (const image::Pixel& p : pixels_of(borders, k, bit))
      if (!box.holds(p.i - axis.x_at(k), p.j - axis.y_at(k))) {
        borders(p.i, p.j, k) &= ~bit;
        ++removed;
      }
  }

  std::optional<Box> box_of(int k, std::uint8_t bit) const {
    const auto pixels = pixels_of(borders, k, bit);
    if (pixels.empty() || coverage_deg(pixels, axis.x_at(k), axis.y_at(k)) < least_coverage_deg) return std::nullopt;
    const auto [left, right] =
        std::minmax_element(pixels.begin(), pixels.end(), [](auto a, auto b) { return a.i < b.i; });
    const auto [up, down] = std::minmax_element(pixels.begin(), pixels.end(), [](auto a, auto b) { return a.j < b.j; });
    const double x = axis.x_at(k), y = axis.y_at(k);
    return Box{left->i - x - margin_px, right->i - x + margin_px, up->j - y - margin_px, down->j - y + margin_px};
  }

  /// Filters slices from `from` down to `to` by every box met on the way.
  void go_down(int from, int to, std::uint8_t bit) {
    Box all;
    for (int k = from; k >= to; --k) {
      remove_outside(all, k, bit);
      if (const auto box = box_of(k, bit))
        all = {std::max(all.x_low, box->x_low), std::min(all.x_high, box->x_high), std::max(all.y_low, box->y_low),
               std::min(all.y_high, box->y_high)};
    }
  }
};

}  // namespace

Mask filter_by_boxes(Mask borders, int big_slice, int division_slice, const Axis& axis, double margin_px,
                     double least_coverage_deg, Notes& notes) {
  const int top = borders.grid.dims[2] - 1;
  if (big_slice < 0 || big_slice > top) {
    notes.push_back({Severity::warning, "boxes.no_big_slice",
                     "No slice has a wide circular border, so the slices could not be checked against one another."});
    return borders;
  }
  Filter filter{borders, axis, margin_px, least_coverage_deg};
  for (const std::uint8_t bit : {Labels::endo_bit, Labels::epi_bit}) {
    if (const auto box = filter.box_of(big_slice, bit))
      for (int k = big_slice + 1; k <= top; ++k) filter.remove_outside(*box, k, bit);
    // The middle ends in the division slice, where the outer border starts anew.
    filter.go_down(big_slice, std::max(0, division_slice), bit);
  }
  if (division_slice > 0) filter.go_down(division_slice, 0, Labels::epi_bit);
  if (filter.removed > 0)
    notes.push_back({Severity::info, "boxes.removed",
                     std::to_string(filter.removed) +
                         " border voxels lie outside the boxes of the slices above and were "
                         "removed."});
  return borders;
}

}  // namespace dynasurf::ventricle
