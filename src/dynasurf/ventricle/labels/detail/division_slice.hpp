#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::ventricle {

/// Mean of the 3x3 pixels around the axis in every slice (thesis 2.5). `image` is normalised; near its sides fewer
/// pixels are averaged, and outside it the value is 0.
std::vector<double> centre_profile(const Image& image, const Axis& axis);

/// SLICE-FIND (thesis 2.5): the first slice, coming from the base, whose centre is brighter than that of the slice
/// above by more than `jump` and is itself brighter than `floor`: there the cavity has ended. `has_edges[k]` tells
/// whether slice k has any edge. Without such a slice the one with the largest rise that ends above `floor` is taken
/// ("slice_find.fallback"); without any, the lowest slice with edges ("slice_find.no_rise"); without edges -1
/// ("slice_find.none").
int find_division_slice(const std::vector<double>& profile, const std::vector<bool>& has_edges,
                        const DivisionSlice& options, Notes& notes);

/// Where the axis meets the wall of the apex.
struct WallTip {
  double slice = 0;       // between slices too
  double brightness = 0;  // of the maximum of the volume
};

/// The first peak on the axis under the lowest slice in which the cavity was seen that reaches `bright`, so that gut
/// under the apex is not taken for it; without one the brightest peak. Slices lie `slice_mm` apart. Blur
/// hides the tip of a cavity, so its inner border seems to end 3 to 12 mm too high; but it also moves the ridge of the
/// bent wall of the apex inwards, onto the true end of the cavity: -0.4 +- 1.1 mm on 100 virtual patients with blur of
/// 8 to 16 mm. Looks 40 mm down. Empty where the axis shows no wall there (a defect of the apex).
std::optional<WallTip> find_wall_tip(const std::vector<double>& profile, int lowest_with_cavity, double slice_mm,
                                     double bright);

/// What table 2.1 of the thesis makes of a division slice.
struct RefinedDivision {
  int slice = -1;
  int table_case = 0;    // 1 to 8; 0: not in the table
  bool verified = true;  // false: the table calls the pattern unlikely or impossible
};

/// SLICE-REFINE (thesis 2.5, table 2.1): looks at C, the division slice, at B and A above it, and for case 3 at the
/// slice above A. `borders(k)` is the number of borders seen in slice k of `slices`: 0, 1 or 2.
/// Only case 5 moves the division slice (to B). Every case but 7 gives the note "slice_refine.case_<n>"; a slice
/// without borders or outside the stack gives "slice_refine.not_in_table".
RefinedDivision refine_division_slice(int division_slice, int slices, const std::function<int(int)>& borders,
                                      Notes& notes);

}  // namespace dynasurf::ventricle
