#pragma once
#include <functional>
#include <span>
#include <vector>

#include "dynasurf/core/detail/fourier.hpp"

// Filters of images that are given by their frequencies. Internal.

namespace dynasurf::synthetic {

/// Multiplies the spectrum of an n × n image, padded by zeros to `size`, a power of 2.
struct PlaneFilter {
  int n = 0, size = 0;
  std::vector<double> response;  // size × size, first axis slowest; even, so that the filtered image is real
  FourierTable table;
};

/// `response(k, l)` at the frequencies k / size and l / size of the first and the second axis, -size / 2 <= k, l <
/// size / 2; must be even in both. `size` is at least 2 n.
PlaneFilter make_plane_filter(int n, const std::function<double(int k, int l, int size)>& response);

/// Filters two images at once: one is the real, the other the imaginary part.
void filter_planes(const PlaneFilter& filter, std::span<float> first, std::span<float> second);

/// The spectrum of the ramp filter as it is sampled: 1/4 at 0, -1 / (pi n)² at odd n, else 0 (Ramachandran and
/// Lakshminarayanan 1971), for lines of n values padded to `size`.
std::vector<double> ramp_spectrum(int size);

}  // namespace dynasurf::synthetic
