#pragma once
#include "dynasurf/core/volume.hpp"

namespace dynasurf::synthetic {

/// Of all voxels.
inline double sum_of(const Image& image) {
  double sum = 0;
  for (float v : image.values) sum += static_cast<double>(v);
  return sum;
}

}  // namespace dynasurf::synthetic
