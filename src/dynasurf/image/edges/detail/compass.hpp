#pragma once
#include <span>

#include "dynasurf/image/edges.hpp"

namespace dynasurf::image {

/// Everything the Compass operator tells of a pixel (Ruzon and Tomasi).
struct CompassMaps {
  Image strength;  // largest distance between the two halves over all orientations, 0 to 1
  Image across_x;  // unit vector across the edge, towards the brighter half
  Image across_y;
  Image abnormality;      // smallest distance: high where no diameter divides the window well (corners, junctions)
  Image uncertainty_deg;  // width of the orientations whose distance is within 2 % of the largest
};

/// The values must be finite; a volume of one value gives zeros. Throws OptionError.
CompassMaps compass_maps(const Image& image, const Compass& options);

/// Earth mover's distance of two distributions on the same values, which grow: mass moves from the lowest that is left
/// of one to the lowest that is left of the other (appendix A.2). That is the cheapest way for a distance that is
/// convex or linear in the difference; for the saturating one of the operator it is the published shortcut and at least
/// as dear. `distance` holds values x values numbers, row by row. Both masses have the same sum, which is not 0; the
/// result is per unit of mass.
double sweep_distance(std::span<const double> mass_a, std::span<const double> mass_b, std::span<const double> distance);

}  // namespace dynasurf::image
