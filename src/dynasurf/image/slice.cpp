#include "dynasurf/image/detail/slice.hpp"

#include <cmath>

#include "dynasurf/core/parallel.hpp"

namespace dynasurf::image {

Slice slice_of(const Image& image, int k) {
  Slice slice(image.grid.dims[0], image.grid.dims[1]);
  const auto begin = image.values.begin() + image.grid.index(0, 0, k);
  std::copy_n(begin, slice.values.size(), slice.values.begin());
  return slice;
}

// Slices of an image lie apart in memory: several threads may put theirs at once.
void put_slice(const Slice& slice, Image& image, int k) {
  std::copy(slice.values.begin(), slice.values.end(), image.values.begin() + image.grid.index(0, 0, k));
}

void for_each_slice(const Grid& grid, const std::function<void(int)>& body) {
  parallel_for(std::max(0, grid.dims[2]), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) body(k);
  });
}

namespace {

/// Convolves a line of doubles that is padded by the radius on both sides; fills the padding.
void smooth_line(const std::vector<double>& w, int count, std::vector<double>& padded, double* out) {
  const int radius = std::ssize(w) - 1;
  std::fill_n(padded.begin(), radius, padded[radius]);
  std::fill_n(padded.begin() + radius + count, radius, padded[radius + count - 1]);
  for (int i = 0; i < count; ++i) out[i] = w[0] * padded[radius + i];
  for (int r = 1; r <= radius; ++r) {
    const double weight = w[r];
    const double* left = padded.data() + radius - r;
    const double* right = padded.data() + radius + r;
    for (int i = 0; i < count; ++i) out[i] += weight * (left[i] + right[i]);
  }
}

}  // namespace

void smooth(Slice& slice, const std::vector<double>& w) {
  const Index width = slice.width, height = slice.height, radius = std::ssize(w) - 1;
  if (radius == 0) return;
  std::vector<double> rows(slice.values.size());
  std::vector<double> line(std::max(width, height) + 2 * radius);
  std::vector<double> column(height);
  for (Index j = 0; j < height; ++j) {
    const auto row = slice.values.begin() + j * width;
    std::copy(row, row + width, line.begin() + radius);
    smooth_line(w, width, line, rows.data() + j * width);
  }
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j < height; ++j) line[radius + j] = rows[j * width + i];
    smooth_line(w, height, line, column.data());
    for (int j = 0; j < height; ++j) slice(i, j) = column[j];
  }
}

SliceVectors central_gradient(const Slice& s) {
  SliceVectors g{Slice(s.width, s.height), Slice(s.width, s.height)};
  for (int j = 0; j < s.height; ++j)
    for (int i = 0; i < s.width; ++i) {
      g.x(i, j) = (s.clamped(i + 1, j) - s.clamped(i - 1, j)) / 2;
      g.y(i, j) = (s.clamped(i, j + 1) - s.clamped(i, j - 1)) / 2;
    }
  return g;
}

Slice lengths_of(const SliceVectors& v) {
  Slice lengths(v.x.width, v.x.height);
  for (std::size_t n = 0; n < lengths.values.size(); ++n) {
    const float x = v.x.values[n], y = v.y.values[n];
    lengths.values[n] = std::sqrt(x * x + y * y);
  }
  return lengths;
}

}  // namespace dynasurf::image
