#pragma once
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::image {

/// Column and row of a pixel of a slice.
struct Pixel {
  int i = 0, j = 0;
  bool operator==(const Pixel&) const = default;
};

/// An 8-connected set of non-zero pixels of one slice (LAB-COMP, thesis 2.3.6). `pixels` are in the order of the
/// slice: row by row, each row from the left.
struct Component {
  int slice = 0;
  std::vector<Pixel> pixels;
};

/// Mean column and row of the pixels. Needs at least one.
struct PixelMean {
  double x_px = 0, y_px = 0;
};
/// The centre of a component.
PixelMean mean_of(const std::vector<Pixel>& pixels);

/// The components of slice `k` in the order of their first pixels; their union is the set of non-zero pixels.
/// Needs 0 <= k < mask.grid.dims[2].
std::vector<Component> components_of_slice(const Mask& mask, int k);

}  // namespace dynasurf::image
