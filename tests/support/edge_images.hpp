#pragma once
// Images for the tests of edge detectors.
#include <algorithm>
#include <cmath>
#include <random>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::test {

Image image_of(int width, int height, int depth, const auto& value) {
  Grid g;
  g.dims = {width, height, depth};
  Image m(g);
  for (int k = 0; k < depth; ++k)
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i) m(i, j, k) = static_cast<float>(value(i, j, k));
  return m;
}

inline Image noise_image(int width, int height, int depth, unsigned seed = 7) {
  std::mt19937_64 random(seed);
  return image_of(width, height, depth, [&](int, int, int) { return static_cast<double>(random() % 1000) / 999; });
}

/// A disc with partial pixels on its rim.
inline Image disc_image(int size, double x, double y, double radius) {
  return image_of(size, size, 1,
                  [&](int i, int j, int) { return std::clamp(radius - std::hypot(i - x, j - y) + 0.5, 0.0, 1.0); });
}

/// 1 where (i, j) lies beyond the line through (x, y) whose normal points to `angle_deg`, with partial pixels.
inline Image step_image(int size, double x, double y, double angle_deg, double low = 0, double high = 1) {
  const double a = angle_deg * 3.14159265358979323846 / 180, c = std::cos(a), s = std::sin(a);
  return image_of(size, size, 1, [&](int i, int j, int) {
    constexpr int fine = 8;
    int inside = 0;
    for (int n = 0; n < fine * fine; ++n)
      inside += (i - x + (n % fine + 0.5) / fine - 0.5) * c + (j - y + (n / fine + 0.5) / fine - 0.5) * s > 0;
    return low + (high - low) * inside / (fine * fine);
  });
}

inline std::size_t count_set(const Mask& m) {
  return static_cast<std::size_t>(std::count_if(m.values.begin(), m.values.end(), [](auto v) { return v != 0; }));
}

}  // namespace dynasurf::test
