#include "dynasurf/image/detail/ridges.hpp"

#include <cmath>
#include <utility>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::image {
namespace {

/// Strength one pixel along (x, y), interpolated between the two pixels of the 3x3 ring on either side of it; exactly
/// theirs where they are equal, so that plateaus stay plateaus. `beside(di, dj)` is the strength of a pixel of the
/// ring.
template <class Beside>
float along(const Beside& beside, float x, float y) {
  const float ax = std::abs(x), ay = std::abs(y);
  const int sx = x < 0 ? -1 : 1, sy = y < 0 ? -1 : 1;
  const float diagonal = beside(sx, sy);
  if (ax >= ay) {
    const float side = beside(sx, 0);
    return side + ay / ax * (diagonal - side);
  }
  const float side = beside(0, sy);
  return side + ax / ay * (diagonal - side);
}

template <class Beside>
bool is_ridge(const Beside& beside, float here, float x, float y) {
  return here > along(beside, x, y) && here >= along(beside, -x, -y);
}

auto clamped_around(const Slice& m, int i, int j) {
  return [&m, i, j](int di, int dj) { return m.clamped(i + di, j + dj); };
}

}  // namespace

bool is_ridge(const Slice& m, int i, int j, float x, float y) {
  if (x == 0 && y == 0) return false;
  const float* here = &m.values[j * m.width + i];
  if (i > 0 && j > 0 && i + 1 < m.width && j + 1 < m.height)
    return is_ridge([&](int di, int dj) { return here[dj * m.width + di]; }, *here, x, y);
  return is_ridge(clamped_around(m, i, j), *here, x, y);
}

RidgeOffset ridge_offset(const Slice& m, int i, int j, float x, float y) {
  const float step = std::max(std::abs(x), std::abs(y));
  if (step == 0) return {};
  const auto beside = clamped_around(m, i, j);
  const float ahead = along(beside, x, y), behind = along(beside, -x, -y);
  const float bend = ahead + behind - 2 * m(i, j);
  // No maximum in between: a plateau, or a pixel that was kept though it is no ridge.
  if (!(bend < 0)) return {};
  const float t = std::clamp((behind - ahead) / (2 * bend), -0.5F, 0.5F);
  // The values were read where the larger component is one pixel.
  return {t * x / step, t * y / step};
}

Slice thin(const Slice& strength, const SliceVectors& across) {
  Slice ridges(strength.width, strength.height);
  for (int j = 0; j < strength.height; ++j)
    for (int i = 0; i < strength.width; ++i)
      if (strength(i, j) > 0 && is_ridge(strength, i, j, across.x(i, j), across.y(i, j))) ridges(i, j) = strength(i, j);
  return ridges;
}

void trace(const Slice& ridges, float low, float high, Mask& edges, int k) {
  std::vector<std::pair<int, int>> stack;
  const auto reaches = [&](int i, int j, float level) { return ridges(i, j) > 0 && ridges(i, j) >= level; };
  for (int j = 0; j < ridges.height; ++j)
    for (int i = 0; i < ridges.width; ++i)
      if (reaches(i, j, high)) edges(i, j, k) = major_edge, stack.emplace_back(i, j);
  while (!stack.empty()) {
    // Canny's hysteresis: what is marked does not depend on the order in which pixels are visited.
    const auto [ci, cj] = stack.back();
    stack.pop_back();
    for (int j = std::max(0, cj - 1); j <= std::min(ridges.height - 1, cj + 1); ++j)
      for (int i = std::max(0, ci - 1); i <= std::min(ridges.width - 1, ci + 1); ++i) {
        if (edges(i, j, k) || !reaches(i, j, low)) continue;
        edges(i, j, k) = major_edge;
        stack.emplace_back(i, j);
      }
  }
}

float largest_of(const Image& image) {
  float max = 0;
  for (const float v : image.values) max = std::max(max, v);
  return max;
}

void require_finite(const Image& image) {
  for (std::size_t n = 0; n < image.values.size(); ++n)
    if (!std::isfinite(image.values[n]))
      throw InputError("image value " + std::to_string(n) + " is not a finite number; expected finite intensities");
}

void require_order(double low, double high, const char* method) {
  if (high >= low) return;
  TextOutput text;
  text << "option " << method << ".high is " << high << "; expected at least " << method << ".low (" << low << ")";
  throw OptionError(text.str());
}

void note_flat(EdgeMap& map) {
  if (largest_of(map.gradient) > 0) return;
  map.notes.push_back(
      {Severity::warning, "edges.flat", "The volume has the same value everywhere in each slice, so it has no edges."});
}

void put_offsets(const Slice& strength, const SliceVectors& across, EdgeMap& map, int k) {
  for (int j = 0; j < strength.height; ++j)
    for (int i = 0; i < strength.width; ++i) {
      if (!map.edges(i, j, k)) continue;
      const RidgeOffset o = ridge_offset(strength, i, j, across.x(i, j), across.y(i, j));
      map.offsets->x_px(i, j, k) = o.x;
      map.offsets->y_px(i, j, k) = o.y;
    }
}

}  // namespace dynasurf::image
