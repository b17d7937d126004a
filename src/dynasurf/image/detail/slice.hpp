#pragma once
#include <algorithm>
#include <functional>
#include <vector>

#include "dynasurf/core/volume.hpp"

// One slice at a time: what the edge detectors share.

namespace dynasurf::image {

/// One slice of floats with replicated borders, row by row.
struct Slice {
  int width = 0, height = 0;
  std::vector<float> values;

  Slice() = default;
  Slice(int w, int h) : width(w), height(h), values(size_of({w, h, 1})) {}
  float& operator()(int i, int j) { return values[j * width + i]; }
  float operator()(int i, int j) const { return values[j * width + i]; }
  float clamped(int i, int j) const {
    return values[std::clamp(j, 0, height - 1) * width + std::clamp(i, 0, width - 1)];
  }
};

Slice slice_of(const Image& image, int k);
void put_slice(const Slice& slice, Image& image, int k);

/// Calls `body(k)` for every slice, in parallel.
void for_each_slice(const Grid& grid, const std::function<void(int)>& body);

/// Separable convolution with a symmetric kernel. The sums run in double, mirrored taps in pairs, and are rounded once:
/// a mirrored or turned slice gives the mirrored or turned floats but for rare last bits.
void smooth(Slice& slice, const std::vector<double>& half_kernel);

struct SliceVectors {
  Slice x, y;
};

/// Central differences per pixel: (I(i+1) - I(i-1)) / 2.
SliceVectors central_gradient(const Slice& slice);

/// Length of every vector.
Slice lengths_of(const SliceVectors& vectors);

}  // namespace dynasurf::image
