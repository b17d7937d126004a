#pragma once
#include <functional>
#include <vector>

#include "dynasurf/field/vector_field.hpp"
#include "dynasurf/image/detail/components.hpp"
#include "dynasurf/ventricle/labels.hpp"

// Reading a field row by row and column by column, as the thesis's first labellers do.

namespace dynasurf::ventricle {

/// Gradient vector flow of every slice by itself, of |grad I|^2 scaled to a maximum of 1: its vectors meet on borders.
/// Those of the image would meet in the middle of the wall.
field::VectorField slice_flow(const Image& image, const SliceFlow& options);

/// A row or a column of a slice of the field.
struct FieldLine {
  std::vector<image::Pixel> pixels;
  std::vector<float> along;   // component along the line, towards growing indices
  std::vector<float> length;  // of the vectors
  std::vector<float> value;   // of the image
};

/// Calls `read` with every row, then every column of slice k, and with the length of its longest vector.
void for_each_line(const Image& image, const field::VectorField& field, int k,
                   const std::function<void(const FieldLine&, double longest)>& read);

/// Places on a line where vectors meet: the component along it turns from + to - by more than `least` in all. Of the
/// two pixels the quieter one, of equally quiet ones the brighter.
std::vector<std::size_t> meeting_points(const FieldLine& line, double least);

/// Local minima of the length below low x longest with more than high x longest within `width_px` on both sides.
std::vector<std::size_t> quiet_points(const FieldLine& line, double longest, const QuietPoints& options);

}  // namespace dynasurf::ventricle
