#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/edges.hpp"

namespace dynasurf {

std::span<const std::string_view> names_of(CannyThreshold) {
  static constexpr std::array<std::string_view, 3> names{"max_fraction", "max_fraction_slice", "percentile"};
  return names;
}

namespace {

/// One slice of floats with replicated borders.
struct Slice {
  int width, height;
  std::vector<float> values;

  Slice(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  float& operator()(int i, int j) { return values[static_cast<std::size_t>(j * width + i)]; }
  float clamped(int i, int j) const {
    return values[static_cast<std::size_t>(std::clamp(j, 0, height - 1) * width + std::clamp(i, 0, width - 1))];
  }
};

/// Weights w[0..radius] of a normalised Gaussian; the other half is the mirror image.
std::vector<double> half_gaussian(double sigma) {
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> w{1.0};
  double sum = 1;
  for (int r = 1; r <= radius; ++r) {
    w.push_back(std::exp(-r * r / (2 * sigma * sigma)));
    sum += 2 * w.back();
  }
  for (double& v : w) v /= sum;
  return w;
}

/// Convolves a line of doubles. Mirrored taps are added in pairs, so a mirrored line gives the mirrored bytes.
void smooth_line(const std::vector<double>& w, int count, std::vector<double>& padded, double* out) {
  const int radius = static_cast<int>(w.size()) - 1;
  std::fill_n(padded.begin(), radius, padded[static_cast<std::size_t>(radius)]);
  std::fill_n(padded.begin() + radius + count, radius, padded[static_cast<std::size_t>(radius + count - 1)]);
  for (int i = 0; i < count; ++i) out[i] = w[0] * padded[static_cast<std::size_t>(radius + i)];
  for (int r = 1; r <= radius; ++r) {
    const double weight = w[static_cast<std::size_t>(r)];
    const double* left = padded.data() + radius - r;
    const double* right = padded.data() + radius + r;
    for (int i = 0; i < count; ++i) out[i] += weight * (left[i] + right[i]);
  }
}

/// Separable Gaussian with replicated borders. The sums run in double and are rounded once: rows before columns then
/// gives the same floats as columns before rows but for rare last bits, and ties of symmetric images stay ties.
void smooth(Slice& slice, const std::vector<double>& w) {
  const int width = slice.width, height = slice.height, radius = static_cast<int>(w.size()) - 1;
  std::vector<double> rows(slice.values.size());
  std::vector<double> line(static_cast<std::size_t>(std::max(width, height) + 2 * radius));
  std::vector<double> column(static_cast<std::size_t>(height));
  for (int j = 0; j < height; ++j) {
    const auto row = slice.values.begin() + static_cast<std::ptrdiff_t>(j) * width;
    std::copy(row, row + width, line.begin() + radius);
    smooth_line(w, width, line, rows.data() + static_cast<std::ptrdiff_t>(j) * width);
  }
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j < height; ++j)
      line[static_cast<std::size_t>(radius + j)] = rows[static_cast<std::size_t>(j * width + i)];
    smooth_line(w, height, line, column.data());
    for (int j = 0; j < height; ++j) slice(i, j) = static_cast<float>(column[static_cast<std::size_t>(j)]);
  }
}

/// Magnitude one pixel along (gx, gy), interpolated between the two pixels of the 3x3 ring on either side of it.
float along(const Slice& m, int i, int j, float gx, float gy) {
  const float ax = std::abs(gx), ay = std::abs(gy);
  const int sx = gx < 0 ? -1 : 1, sy = gy < 0 ? -1 : 1;
  const float diagonal = m.clamped(i + sx, j + sy);
  if (ax >= ay) {
    const float t = ay / ax;
    return (1 - t) * m.clamped(i + sx, j) + t * diagonal;
  }
  const float t = ax / ay;
  return (1 - t) * m.clamped(i, j + sy) + t * diagonal;
}

/// Gradient magnitude of a slice, and the same with everything but its ridges set to 0.
struct Ridges {
  Slice magnitude, thin;
};

Ridges find_ridges(const Slice& s) {
  Ridges r{Slice(s.width, s.height), Slice(s.width, s.height)};
  Slice gx(s.width, s.height), gy(s.width, s.height);
  for (int j = 0; j < s.height; ++j)
    for (int i = 0; i < s.width; ++i) {
      gx(i, j) = (s.clamped(i + 1, j) - s.clamped(i - 1, j)) / 2;
      gy(i, j) = (s.clamped(i, j + 1) - s.clamped(i, j - 1)) / 2;
      r.magnitude(i, j) = std::sqrt(gx(i, j) * gx(i, j) + gy(i, j) * gy(i, j));
    }
  for (int j = 0; j < s.height; ++j)
    for (int i = 0; i < s.width; ++i) {
      const float m = r.magnitude(i, j);
      if (m == 0) continue;
      // Of a plateau the pixel on the bright side stays: strict uphill, not strict downhill. The rule follows the
      // gradient, not the image axes, so a rotated image gives the rotated edges.
      const bool ridge =
          m > along(r.magnitude, i, j, gx(i, j), gy(i, j)) && m >= along(r.magnitude, i, j, -gx(i, j), -gy(i, j));
      if (ridge) r.thin(i, j) = m;
    }
  return r;
}

struct Thresholds {
  float low, high;
};

/// Value below which a share `q` of the non-zero values lies; 0 when there are none.
float quantile_of_nonzero(std::vector<float> values, double q) {
  std::erase(values, 0.0F);
  if (values.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

Thresholds thresholds_of(const std::vector<float>& thin, float max, const Canny& o) {
  if (o.threshold != CannyThreshold::percentile)
    return {static_cast<float>(o.low * max), static_cast<float>(o.high * max)};
  const float high = quantile_of_nonzero(thin, o.high);
  return {static_cast<float>(o.low * high), high};
}

constexpr std::uint8_t major_edge = 2;

/// Marks the ridges above `high` and those above `low` that hang on them.
void trace(const float* thin, int width, int height, Thresholds t, std::uint8_t* edges) {
  const auto at = [&](int i, int j) { return static_cast<std::ptrdiff_t>(j) * width + i; };
  std::vector<std::pair<int, int>> stack;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      if (thin[at(i, j)] > 0 && thin[at(i, j)] >= t.high) edges[at(i, j)] = major_edge, stack.emplace_back(i, j);
  while (!stack.empty()) {
    const auto [ci, cj] = stack.back();
    stack.pop_back();
    for (int j = std::max(0, cj - 1); j <= std::min(height - 1, cj + 1); ++j)
      for (int i = std::max(0, ci - 1); i <= std::min(width - 1, ci + 1); ++i) {
        if (edges[at(i, j)] || !(thin[at(i, j)] > 0 && thin[at(i, j)] >= t.low)) continue;
        edges[at(i, j)] = major_edge;
        stack.emplace_back(i, j);
      }
  }
}

void require_usable(const Image& image, const Canny& options) {
  Canny checked = options;
  check_options(checked, "canny");
  if (options.high < options.low) {
    std::ostringstream text;
    text << "option canny.high is " << options.high << "; expected at least canny.low (" << options.low << ")";
    throw OptionError(text.str());
  }
  for (std::size_t n = 0; n < image.values.size(); ++n)
    if (!std::isfinite(image.values[n]))
      throw InputError("image value " + std::to_string(n) + " is not a finite number; expected finite intensities");
}

}  // namespace

EdgeMap detect_edges(const Image& image, const Canny& options) {
  require_usable(image, options);
  const int width = image.grid.dims[0], height = image.grid.dims[1];
  const auto depth = static_cast<std::size_t>(image.grid.dims[2]);
  const std::size_t area = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  EdgeMap map{Mask(image.grid), Image(image.grid), {}};
  Image thin(image.grid);

  const std::vector<double> weights = half_gaussian(options.sigma_px);
  parallel_for(depth, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Slice slice(width, height);
      std::copy_n(image.values.begin() + static_cast<std::ptrdiff_t>(k * area), area, slice.values.begin());
      if (options.sigma_px > 0) smooth(slice, weights);
      const Ridges ridges = find_ridges(slice);
      std::copy_n(ridges.magnitude.values.begin(), area,
                  map.gradient.values.begin() + static_cast<std::ptrdiff_t>(k * area));
      std::copy_n(ridges.thin.values.begin(), area, thin.values.begin() + static_cast<std::ptrdiff_t>(k * area));
    }
  });

  const auto largest = [&](std::size_t from, std::size_t count) {
    float max = 0;
    for (std::size_t n = from; n < from + count; ++n) max = std::max(max, map.gradient.values[n]);
    return max;
  };
  const float max = largest(0, map.gradient.values.size());
  const Thresholds common = thresholds_of(thin.values, max, options);
  parallel_for(depth, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const bool own = options.threshold == CannyThreshold::max_fraction_slice;
      const Thresholds t = own ? thresholds_of({}, largest(k * area, area), options) : common;
      trace(thin.values.data() + k * area, width, height, t, map.edges.values.data() + k * area);
    }
  });

  if (max == 0)
    map.notes.push_back({Severity::warning, "edges.flat",
                         "The volume has the same value everywhere in each slice, so it has no edges."});
  return map;
}

EdgeMap detect_edges(const Image& image, const EdgeOptions& options) {
  return std::visit([&](const auto& method) { return detect_edges(image, method); }, options);
}

}  // namespace dynasurf
