#pragma once
#include <string>
#include <vector>

#include "dynasurf/show/detail/canvas.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::show {

// All slices of one gate on one sheet, from the apex on, row by row, each with its number (from 1), under a title and
// a legend. A voxel is a whole number of points wide.

/// The edges over the slices (VIS-EDGES): major edges yellow, minor ones orange.
Canvas draw_edges(const Image& image, const image::EdgeMap& edges, const std::string& title);

/// What the labelling found (VIS-LABEL): edges left over yellow, outer border red, inner blue, both or not told apart
/// pink; coarse circle grey, automatic circle white; boxes of the borders in their colours; the centre of the best
/// circle of a slice a green cross, the axis a white one. The division slice has a white frame.
Canvas draw_labels(const Image& image, const ventricle::GateBorders& gate, const ventricle::Circle& coarse,
                   const std::string& title);

/// Edge pixels counted in rings around the axis (VIS-RADIAL): beside each slice with the circles of its peaks, three
/// graphs for rings of 1, 2 and 3 pixels, their peaks in red.
Canvas draw_rings(const Image& image, const ventricle::GateBorders& gate, const ventricle::RadialLabels& options,
                  const std::string& title);

/// A closed surface (world frame) cut by the slices that it meets, at most 36 of them evenly spaced, over the image
/// around it.
Canvas draw_sections(const Image& image, const TriMesh& surface, const std::string& title);

/// One choice of options and what came of it.
struct MatrixCell {
  std::string name;
  ventricle::BorderResult borders;  // of one gate
};
enum class MatrixDrawing { edges, labels };

/// One slice of the first gate under many choices (VIS-EDGES: the matrices of the thesis), rows as given, cut to the
/// surroundings of the coarse circle. `slice` counts from 0; a choice whose stack does not reach it stays empty.
/// `rows` are not empty and equally long.
Canvas draw_matrix(const std::vector<std::vector<MatrixCell>>& rows, int slice, MatrixDrawing what,
                   const std::string& title);

}  // namespace dynasurf::show
