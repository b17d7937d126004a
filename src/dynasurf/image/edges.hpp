#pragma once
#include <optional>
#include <span>
#include <string_view>
#include <variant>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::image {

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
  bool subpixel = false;
};
void describe(auto& visit, Canny& o) {
  visit("sigma_px", o.sigma_px,
        OptionInfo{"width of the Gaussian before the gradient; 0 does not smooth (thesis 6.1.4: 1.8)", "px", 0, 20});
  visit("low", o.low, OptionInfo{"lower hysteresis threshold (thesis 6.1.4: 0.3)", "", 0, 1});
  visit("high", o.high, OptionInfo{"upper hysteresis threshold, at least `low` (thesis 6.1.4: 0.7)", "", 0, 1});
  visit("threshold", o.threshold, OptionInfo{"what the thresholds are fractions of"});
  visit("subpixel", o.subpixel, OptionInfo{"tell where in its pixel each edge lies"});
}

/// Canny's detector with Ding and Goshtasby's minor edges, which close the gaps at branches (EDGE-CANNY-REV,
/// thesis 2.2.2).
struct CannyRevised {
  static constexpr std::string_view name = "canny_revised";
  Canny canny{};
};
void describe(auto& visit, CannyRevised& o) {
  visit("canny", o.canny, OptionInfo{"the detector that gives the major edges"});
}

/// The measure that marks an edge.
enum class GradientMeasure {
  squared,    // |grad I|^2, eq. 2.1
  magnitude,  // |grad I|
  laplacian,  // |d2I/dx2 + d2I/dy2|, the other reading of eq. 2.1
  roberts,    // Roberts' cross: the differences along the two diagonals of 2x2 pixels
};
std::span<const std::string_view> names_of(GradientMeasure);

/// Plain gradient, which the thesis calls "Robert" (EDGE-GRAD, thesis 2.2.1, eq. 2.1).
struct GradientEdges {
  static constexpr std::string_view name = "gradient";
  GradientMeasure measure = GradientMeasure::squared;
  double threshold = 0.2;
  bool thin = false;
  bool subpixel = false;
};
void describe(auto& visit, GradientEdges& o) {
  visit("measure", o.measure, OptionInfo{"what is compared with the threshold (eq. 2.1 can be read in two ways)"});
  visit("threshold", o.threshold, OptionInfo{"least measure of an edge", "of the volume's maximum", 0, 1});
  visit(
      "thin", o.thin,
      OptionInfo{"keep only the ridges of the measure, of the Laplacian its zero crossings; false: all that reach it"});
  visit("subpixel", o.subpixel, OptionInfo{"tell where in its pixel each edge lies"});
}

/// Sobel's operator (EDGE-SOBEL, thesis 2.2.4, eqs 2.2-2.3).
struct SobelEdges {
  static constexpr std::string_view name = "sobel";
  double threshold = 0.4;
  bool thin = false;
  bool subpixel = false;
};
void describe(auto& visit, SobelEdges& o) {
  visit("threshold", o.threshold, OptionInfo{"least magnitude of an edge", "of the volume's maximum", 0, 1});
  visit("thin", o.thin, OptionInfo{"keep only the ridges of the magnitude; false: all that reach the threshold"});
  visit("subpixel", o.subpixel, OptionInfo{"tell where in its pixel each edge lies"});
}

/// Ruzon and Tomasi's Compass operator: compares the distributions of the values in two half discs (EDGE-COMPASS,
/// thesis 2.2.3).
struct Compass {
  static constexpr std::string_view name = "compass";
  double sigma_px = 1.0;
  double low = 0.3;
  double high = 0.7;
  int clusters = 10;
  int wedges = 6;
  double gamma = 0.14;
  bool subpixel = false;
};
void describe(auto& visit, Compass& o) {
  visit("sigma_px", o.sigma_px, OptionInfo{"the window's radius is three times this", "px", 0.2, 7});
  visit("low", o.low, OptionInfo{"lower hysteresis threshold, a distance of distributions", "", 0, 1});
  visit("high", o.high, OptionInfo{"upper hysteresis threshold, at least `low`", "", 0, 1});
  visit("clusters", o.clusters, OptionInfo{"most values a distribution is reduced to", "", 2, 10});
  visit("wedges", o.wedges, OptionInfo{"wedges per quarter turn; twice as many orientations are tried", "", 2, 12});
  visit("gamma", o.gamma,
        OptionInfo{"difference of values that counts as different: distance 1 - exp(-d / gamma)",
                   "of the volume's range", 0.001, 100});
  visit("subpixel", o.subpixel, OptionInfo{"tell where in its pixel each edge lies"});
}

/// What contours are expected to be like (FUT-ACC, thesis ch. 8).
enum class ContourPrior { none, circle, ellipse };
std::span<const std::string_view> names_of(ContourPrior);

/// Heat that flows along contours only, then Canny (EDGE-ACC, anisotropic contour completion, thesis 6.1.6).
struct ContourCompletion {
  static constexpr std::string_view name = "acc";
  double gradient_sigma_px = 1;
  double tensor_sigma_px = 3;
  double step = 0.2;
  int steps = 75;
  int refresh = 0;
  bool complete = false;
  double complete_level = 0.25;
  ContourPrior prior = ContourPrior::none;
  double prior_weight = 0.5;
  std::optional<double> prior_x_px = {}, prior_y_px = {};
  Canny canny{};
};
void describe(auto& visit, ContourCompletion& o) {
  visit("gradient_sigma_px", o.gradient_sigma_px,
        OptionInfo{"s: smoothing before the tensor's gradients", "px", 0, 20});
  visit("tensor_sigma_px", o.tensor_sigma_px, OptionInfo{"rho: window in which the tangent is common", "px", 0.1, 20});
  visit("step", o.step, OptionInfo{"time step", "px^2", 0.001, 0.25});
  visit("steps", o.steps, OptionInfo{"number of steps (50 to 100)", "", 0, 100000});
  visit("refresh", o.refresh, OptionInfo{"compute the tangents anew after so many steps; 0: once", "", 0, 100000});
  visit("complete", o.complete,
        OptionInfo{
            "diffuse the contours that Canny finds instead of the image, and add what bridges them as minor edges"});
  visit("complete_level", o.complete_level, OptionInfo{"heat that makes a bridge, 1 on the contour", "", 0.001, 1});
  visit(
      "prior", o.prior,
      OptionInfo{"circle, ellipse: heat also flows along circles or ellipses about one middle, fitted to the edges of "
                 "the slice that Canny finds"});
  visit("prior_weight", o.prior_weight, OptionInfo{"1: along these alone, 0: along what is seen alone", "", 0, 1});
  visit("prior_x_px", o.prior_x_px, OptionInfo{"their middle, column; unset: fitted", "px"});
  visit("prior_y_px", o.prior_y_px, OptionInfo{"their middle, row; unset: fitted", "px"});
  visit("canny", o.canny, OptionInfo{"the detector that finds the edges"});
}

/// The edge detectors.
using EdgeOptions = std::variant<Canny, CannyRevised, GradientEdges, SobelEdges, Compass, ContourCompletion>;

/// Where the edge lies, px from the centre of its pixel along i and j, at most one half; 0 where there is no edge.
struct EdgeOffsets {
  Image x_px, y_px;
};

/// Edges of every slice. `gradient` holds the strength the thresholds were applied to.
struct EdgeMap {
  Mask edges;      // 0 none, 1 minor, 2 major. Every non-zero pixel is an edge.
  Image gradient;  // Canny: per px; Sobel: 8 times that; gradient: per mm or mm^2; compass: 0 to 1
  Notes notes;
  std::optional<EdgeOffsets> offsets;  // with `subpixel`
};

/// Edges of a normalised volume, slice by slice. Borders are replicated. A constant volume gives none.
/// Of a step between two pixels the thinning detectors mark the brighter one. A constant volume gets the note
/// "edges.flat".
/// Throws OptionError when high < low or a parameter is out of range, InputError for values that are not finite.
EdgeMap detect_edges(const Image& image, const Canny& options);
EdgeMap detect_edges(const Image& image, const CannyRevised& options);
EdgeMap detect_edges(const Image& image, const GradientEdges& options);
EdgeMap detect_edges(const Image& image, const SobelEdges& options);
EdgeMap detect_edges(const Image& image, const Compass& options);
EdgeMap detect_edges(const Image& image, const ContourCompletion& options);
EdgeMap detect_edges(const Image& image, const EdgeOptions& options);

}  // namespace dynasurf::image
