#pragma once
#include "dynasurf/field/vector_field.hpp"
#include "dynasurf/show/detail/chart.hpp"

namespace dynasurf::show {

/// The part of a slice that is shown, voxels.
struct Cutout {
  int i = 0, j = 0, columns = 0, rows = 0;
};

/// Around the voxels above 0, with `margin` voxels of room; the whole slice where there are none.
Cutout window_around(const Image& values, int margin);

/// Where a window lies in a drawing, true to the spacing and as large as the box allows.
struct SliceMap {
  Cutout window;
  Panel box;
  double column = 1, row = 1;  // points of a voxel
  /// The centre of a voxel, or a place between.
  Vec2 at(double i, double j) const {
    return {box.x + (i - window.i + 0.5) * column, box.y + (j - window.j + 0.5) * row};
  }
};
SliceMap map_of(const Grid& grid, const Cutout& window, const Panel& box);

/// A slice in greys, white at `most`.
void draw_slice(Canvas& canvas, const SliceMap& map, const Image& image, int k, double most);
/// An arrow for every voxel, its colour by the vector's length: yellow at `longest`. Those below a thousandth of it are
/// left out.
void draw_vectors(Canvas& canvas, const SliceMap& map, const field::VectorField& field, int k, double longest);
/// The largest length in a window of slice k; 1e-12 at least.
double longest_in(const field::VectorField& field, const Cutout& window, int k);

}  // namespace dynasurf::show
