#include "dynasurf/image/intensity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/image/detail/gaussian.hpp"
#include "dynasurf/image/detail/slice.hpp"

namespace dynasurf::image {
namespace {

float largest(const Image& image) {
  return image.values.empty() ? 0.0F : *std::max_element(image.values.begin(), image.values.end());
}

}  // namespace

Image normalise(Image image, Notes& notes) {
  const float max = largest(image);
  if (!(max > 0)) {
    notes.push_back({Severity::warning, "normalise.empty",
                     "The volume has no value above zero (largest value " + std::to_string(max) +
                         "), so its values were left as they are."});
    return image;
  }
  for (float& v : image.values) v /= max;
  return image;
}

void stretch_to_range(std::span<Image> images, Notes& notes) {
  float least = std::numeric_limits<float>::infinity(), most = -least;
  for (const Image& image : images)
    for (const float v : image.values) least = std::min(least, v), most = std::max(most, v);
  if (!(most > least)) {
    notes.push_back({Severity::warning, "normalise.flat", "The data hold one value only, so it was left as it is."});
    return;
  }
  for (Image& image : images)
    for (float& v : image.values) v = (v - least) / (most - least);
}

Image suppress_noise(Image image, double fraction) {
  if (!(fraction >= 0 && fraction <= 1)) {
    TextOutput text;
    text << "option noise_fraction is " << fraction << "; expected a number >= 0 and <= 1";
    throw OptionError(text.str());
  }
  if (fraction == 0) return image;
  const double threshold = fraction * largest(image);
  for (float& v : image.values)
    if (v < threshold) v = 0;
  return image;
}

std::span<const std::string_view> names_of(DoublingMask) {
  static constexpr std::array<std::string_view, 2> names{"three", "single"};
  return names;
}

Image threshold_at(Image image, double level) {
  for (float& v : image.values) v = v >= level ? 1.0F : 0.0F;
  return image;
}

Image double_resolution(const Image& image, DoublingMask mask) {
  Grid grid = image.grid;
  for (int& n : grid.dims) n *= 2;
  grid.spacing /= 2;
  // The first of two halves of a voxel: its centre lies half of its own side before the old one.
  grid.origin -= grid.direction * grid.spacing / 2;
  Image result(grid);
  const float beside = mask == DoublingMask::three ? 0.5F : 0.0F, diagonal = mask == DoublingMask::three ? 0.5F : 1.5F;
  for_each_slice(grid, [&](int k) {
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        // The neighbours on the side of this quadrant.
        const int a = i % 2 ? 1 : -1, b = j % 2 ? 1 : -1, c = k % 2 ? 1 : -1;
        const auto plane = [&](int z) {
          return (2.5F * image.clamped(i / 2, j / 2, z) +
                  beside * (image.clamped(i / 2 + a, j / 2, z) + image.clamped(i / 2, j / 2 + b, z)) +
                  diagonal * image.clamped(i / 2 + a, j / 2 + b, z)) /
                 4;
        };
        result(i, j, k) = (3 * plane(k / 2) + plane(k / 2 + c)) / 4;
      }
  });
  return result;
}

Image cut_property(Image image, const PropertyCut& cut) {
  if (!(cut.radius_px >= 0 && cut.band_px >= 0 && cut.sigma_px >= 0))
    throw OptionError("property cut: radius, band and width are expected to be >= 0 px");
  const auto half = half_gaussian(cut.sigma_px);
  for_each_slice(image.grid, [&](int k) {
    Slice slice = slice_of(image, k);
    const auto beyond = [&](int i, int j) { return own::hypot(i - cut.x_px, j - cut.y_px) - cut.radius_px; };
    for (int j = 0; j < slice.height; ++j)
      for (int i = 0; i < slice.width; ++i)
        if (beyond(i, j) > 0) slice(i, j) = 0;
    if (cut.soft) {
      Slice smoothed = slice;
      smooth(smoothed, half);
      for (int j = 0; j < slice.height; ++j)
        for (int i = 0; i < slice.width; ++i)
          // From the values after the cut, so that the step of the cut itself is softened.
          if (std::abs(beyond(i, j)) <= cut.band_px) slice(i, j) = smoothed(i, j);
    }
    put_slice(slice, image, k);
  });
  return image;
}

Image prepare(Image image, const Preparation& o) {
  if (o.cut_radius_px) {
    const PropertyCut cut{.x_px = o.cut_x_px.value_or((image.grid.dims[0] - 1) / 2.0),
                          .y_px = o.cut_y_px.value_or((image.grid.dims[1] - 1) / 2.0),
                          .radius_px = *o.cut_radius_px,
                          .soft = o.soft_cut};
    image = cut_property(std::move(image), cut);
  }
  if (o.doubling != Preparation::Doubling::none)
    image = double_resolution(image,
                              o.doubling == Preparation::Doubling::three ? DoublingMask::three : DoublingMask::single);
  if (o.threshold) {
    const auto level = *o.threshold * largest(image);
    image = threshold_at(std::move(image), level);
  }
  return image;
}

}  // namespace dynasurf::image
