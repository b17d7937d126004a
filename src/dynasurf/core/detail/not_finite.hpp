#pragma once
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf {

/// How many values of each gate are not finite numbers.
inline std::vector<std::size_t> not_finite_in(std::span<const Image> gates) {
  std::vector<std::size_t> counts(gates.size());
  parallel_for(gates.size(), 1, [&](std::size_t g, std::size_t) {
    counts[g] = std::ranges::count_if(gates[g].values, [](float v) { return !std::isfinite(v); });
  });
  return counts;
}

/// The first voxel whose value is not a finite number. Needs one.
inline std::size_t first_not_finite(const Image& image) {
  return std::ranges::find_if(image.values, [](float v) { return !std::isfinite(v); }) - image.values.begin();
}

}  // namespace dynasurf
