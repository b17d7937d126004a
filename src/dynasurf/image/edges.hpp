#pragma once
#include <span>
#include <string_view>
#include <variant>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf {

/// What the two thresholds of Canny's hysteresis mean (the thesis does not say, O2).
enum class CannyThreshold {
  max_fraction,        // of the largest gradient magnitude of the volume
  max_fraction_slice,  // of the largest gradient magnitude of the slice
  percentile,          // high: quantile of the non-zero thinned magnitudes; low: fraction of the high value
};
std::span<const std::string_view> names_of(CannyThreshold);

/// Canny's edge detector, slice by slice (EDGE-CANNY, thesis 2.2.2).
///
/// The thesis's values are 1.8 px, 0.3 and 0.7 (or 0.8). On emission images blurred by 8 to 16 mm they lose the inner
/// border of one slice in four and move it a pixel and a half inwards; the defaults lose one in two hundred. Measured
/// in docs/stages/edges.md.
struct Canny {
  static constexpr std::string_view name = "canny";
  double sigma_px = 1.0;
  double low = 0.15;
  double high = 0.3;
  CannyThreshold threshold = CannyThreshold::max_fraction;
};
void describe(auto& visit, Canny& o) {
  visit("sigma_px", o.sigma_px,
        Field{"width of the Gaussian before the gradient; 0 does not smooth (thesis 6.1.4: 1.8)", "px", 0, 20});
  visit("low", o.low, Field{"lower hysteresis threshold (thesis 6.1.4: 0.3)", "", 0, 1});
  visit("high", o.high, Field{"upper hysteresis threshold, at least `low` (thesis 6.1.4: 0.7)", "", 0, 1});
  visit("threshold", o.threshold, Field{"what the thresholds are fractions of"});
}

using EdgeOptions = std::variant<Canny>;

/// Edges of every slice. `gradient` holds the magnitude the thresholds were applied to.
struct EdgeMap {
  Mask edges;      // 0 none, 1 minor, 2 major; Canny's are all major. Every non-zero pixel is an edge.
  Image gradient;  // per px
  Notes notes;
};

/// Edges of a normalised volume, slice by slice. Borders are replicated. A constant volume gives none.
/// Of a step between two pixels the brighter one is marked. A constant volume gets the note "edges.flat".
/// Throws OptionError when high < low or a parameter is out of range, InputError for values that are not finite.
EdgeMap detect_edges(const Image& image, const Canny& options);
EdgeMap detect_edges(const Image& image, const EdgeOptions& options);

}  // namespace dynasurf
