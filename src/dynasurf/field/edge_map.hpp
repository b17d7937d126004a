#pragma once
#include <span>
#include <string_view>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::field {

/// What of an image a field is made from.
enum class EdgeOperator { gradient_squared, gradient, intensity };
std::span<const std::string_view> names_of(EdgeOperator);

/// The edge map of a grey image (FLD-EDGEMAP, thesis 3.3.4, eqs 6.1-6.2). Fields point up the map, so it is high where
/// surfaces shall go; the thesis prints it as an energy, of the other sign.
struct EdgeMapOptions {
  EdgeOperator of = EdgeOperator::gradient_squared;
  double sigma_px = 0;
  bool reversed = false;
};
void describe(auto& visit, EdgeMapOptions& o) {
  visit(
      "of", o.of,
      OptionInfo{"squared length of the gradient (eq. 6.1), its length, or the values themselves (eq. 6.2, for binary "
                 "data)"});
  visit("sigma_px", o.sigma_px, OptionInfo{"Gaussian before the operator (eqs 3.22, 3.24); 0: none", "px", 0, 20});
  visit("reversed", o.reversed, OptionInfo{"the map upside down, as in the failed tests of fig 3.20"});
}

/// The map on the image's grid, its largest value 1, or with `reversed` its smallest -1; all 0 for a constant image.
/// Gradients are per mm, central inside and one-sided on the faces of the grid. Throws InputError for values that are
/// not finite.
Image edge_map_of(const Image& image, const EdgeMapOptions& options);

}  // namespace dynasurf::field
