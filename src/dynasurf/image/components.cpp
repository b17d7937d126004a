#include "dynasurf/image/detail/components.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <tuple>

namespace dynasurf::image {
namespace {

/// Takes everything connected to `seed` out of `open` (one flag per pixel of a slice of `width` columns).
std::vector<Pixel> flood(std::vector<std::uint8_t>& open, int width, int height, Pixel seed) {
  const auto at = [&](int i, int j) -> std::uint8_t& { return open[j * width + i]; };
  std::vector<Pixel> pixels{seed};
  at(seed.i, seed.j) = 0;
  for (std::size_t next = 0; next < pixels.size(); ++next) {
    const Pixel p = pixels[next];
    for (int j = std::max(0, p.j - 1); j <= std::min(height - 1, p.j + 1); ++j)
      for (int i = std::max(0, p.i - 1); i <= std::min(width - 1, p.i + 1); ++i) {
        if (!at(i, j)) continue;
        at(i, j) = 0;
        pixels.push_back({i, j});
      }
  }
  std::sort(pixels.begin(), pixels.end(),
            [](const Pixel& a, const Pixel& b) { return std::tie(a.j, a.i) < std::tie(b.j, b.i); });
  return pixels;
}

}  // namespace

PixelMean mean_of(const std::vector<Pixel>& pixels) {
  double x = 0, y = 0;
  for (const Pixel& p : pixels) x += p.i, y += p.j;
  const double n = pixels.size();
  return {x / n, y / n};
}

std::vector<Component> components_of_slice(const Mask& mask, int k) {
  const int width = mask.grid.dims[0], height = mask.grid.dims[1];
  const auto begin = mask.values.begin() + mask.grid.index(0, 0, k);
  std::vector<std::uint8_t> open(begin, begin + mask.grid.slice_size());
  std::vector<Component> components;
  // Nearly all pixels are none of a component: they are passed by eight at a time.
  std::uint64_t some = 0;
  for (std::size_t at = 0; at < open.size();) {
    if (at + sizeof some <= open.size()) {
      std::memcpy(&some, &open[at], sizeof some);
      if (some == 0) {
        at += sizeof some;
        continue;
      }
    }
    const int here = at++;
    if (open[here]) components.push_back({k, flood(open, width, height, {here % width, here / width})});
  }
  return components;
}

}  // namespace dynasurf::image
