#pragma once
#include "dynasurf/core/grid.hpp"
#include "dynasurf/report/detail/page_parts.hpp"
#include "dynasurf/ventricle/result.hpp"

// The images of a study and what was found on them, for the pages.
namespace dynasurf::report::detail {

/// In-plane binning that keeps a page within its bound: 1 for every usual study.
int bin_of(const Study& study, std::size_t most_voxels);

/// All gates as a byte per bin, its mean, 255 the largest value of the study; negative values are black, and what is
/// not finite counts as 0.
Bytes image_bytes(const Study& study, int bin);

/// Borders and edges of one gate, a byte per bin: 1 endo, 2 epi, 4 minor edge, 8 major edge.
Bytes mark_bytes(const Grid& grid, const Mask& borders, const Mask& edges, int bin);

Json grid_json(const Grid& grid);

/// Images, borders and edges of all gates; null without a gate.
Json pictures_json(const ventricle::Result& result, std::size_t most_voxels);

}  // namespace dynasurf::report::detail
