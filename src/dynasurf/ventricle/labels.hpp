#pragma once
#include <optional>
#include <vector>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/image/edges.hpp"

namespace dynasurf::ventricle {

/// The two borders of the wall: the inner (endocardial) and the outer (epicardial) one.
enum class Border { endo, epi };
inline std::string_view name_of(Border w) { return w == Border::endo ? "endo" : "epi"; }

/// A circle in the plane of a slice.
struct Circle {
  double x_px = 0, y_px = 0, radius_px = 0;
};

/// The long axis of the ventricle: where its centre lies in every slice, columns and rows.
struct Axis {
  double x_px = 0, y_px = 0;    // at slice 0
  double dx_px = 0, dy_px = 0;  // per slice; 0 for a stack cut square to the axis
  double x_at(int k) const { return x_px + k * dx_px; }
  double y_at(int k) const { return y_px + k * dy_px; }
};

/// CIRC-COARSE (thesis 2.4): the circle outside which nothing is looked at. The thesis has it drawn by hand. Unset it
/// is the largest circle inside the image: a smaller one (0.35 of the side) cuts a ventricle that lies 15 mm off centre
/// or fills a narrow field of view, and the automatic circle does not need it.
struct CoarseCircle {
  std::optional<double> x_px, y_px, radius_px;
};
void describe(auto& visit, CoarseCircle& o) {
  visit("x_px", o.x_px, OptionInfo{"centre, column; unset: middle of the image", "px"});
  visit("y_px", o.y_px, OptionInfo{"centre, row; unset: middle of the image", "px"});
  visit("radius_px", o.radius_px, OptionInfo{"radius; unset: half the shorter image side", "px", 1});
}

/// LAB-COMP, CIRC-CENTROID, CIRC-RADIUS (thesis 2.3.6, 2.4.1, 2.4.2).
struct AutoCircle {
  int min_component_px = 6;
  double centroid_tolerance_px = 1.5;
  double centroid_share = 0.6;
  double radius_tolerance_px = 1.5;
  double radius_share = 0.5;
  double centre_width = 0.15;
  double offset_px = 2;
  bool robust_fit = true;
};
void describe(auto& visit, AutoCircle& o) {
  visit("min_component_px", o.min_component_px,
        OptionInfo{"edges with fewer pixels are noise (n_min)", "px", 1, 10000});
  visit("centroid_tolerance_px", o.centroid_tolerance_px, OptionInfo{"tau of CIRC-CENTROID", "px", 0.1, 20});
  visit("centroid_share", o.centroid_share,
        OptionInfo{"share of a border at one distance for it to be a circle (T_circ)", "", 0, 1});
  visit("radius_tolerance_px", o.radius_tolerance_px, OptionInfo{"tau of CIRC-RADIUS", "px", 0.1, 20});
  visit("radius_share", o.radius_share, OptionInfo{"T_r of CIRC-RADIUS", "", 0, 1});
  visit("centre_width", o.centre_width,
        OptionInfo{"s_c: width of the preference for the image centre, share of the image width", "", 0.01, 10});
  visit("offset_px", o.offset_px, OptionInfo{"added to the radius that was found", "px", 0, 50});
  visit("robust_fit", o.robust_fit,
        OptionInfo{"fit circles algebraically instead of by centroid (arcs stay unbiased)"});
}

/// SLICE-FIND and SLICE-REFINE (thesis 2.5).
struct DivisionSlice {
  double jump = 0.15;
  double floor = 0.4;
  std::optional<double> expected_slice;
};
void describe(auto& visit, DivisionSlice& o) {
  visit("jump", o.jump,
        OptionInfo{"rise of the centre from one slice to the next that marks the apex wall", "of the maximum", 0, 1});
  visit("floor", o.floor, OptionInfo{"least value of the centre in the apex wall", "of the maximum", 0, 1});
  visit("expected_slice", o.expected_slice,
        OptionInfo{
            "where the shape of the whole heart has the end of the cavity, 0: middle of the lowest slice; taken where "
            "the wall under the cavity is not seen near it; unset: from the heart that was found, if one was"});
}

/// LAB-MLC (thesis 2.3.6) and BBOX-FILTER (thesis 2.6).
struct Mlc {
  static constexpr std::string_view name = "mlc";
  bool strict_thesis = false;
  bool use_gradient = true;
  double min_gap_px = 2;
  double box_margin_px = 2;
};
void describe(auto& visit, Mlc& o) {
  visit("strict_thesis", o.strict_thesis, OptionInfo{"exactly the published rule: the largest gap decides, always"});
  visit("use_gradient", o.use_gradient,
        OptionInfo{"tell the borders by the side on which the wall is brighter; without effect in strict_thesis"});
  visit("min_gap_px", o.min_gap_px,
        OptionInfo{"smaller gaps are fragments of one border; neighbours decide then", "px", 0, 50});
  visit("box_margin_px", o.box_margin_px,
        OptionInfo{"slack of the bounding boxes: a wall bulges (thesis: 0)", "px", 0, 50});
}

/// LAB-NONE (thesis 2.3.1): nothing is told apart, every edge inside the automatic circle stays a border of either
/// wall.
struct NoLabels {
  static constexpr std::string_view name = "none";
};
void describe(auto&, NoLabels&) {}

/// The field of a slice that the first labellers read: gradient vector flow of |grad I|^2, in two dimensions.
struct SliceFlow {
  double mu = 0.05;
  int iterations = 60;
};
void describe(auto& visit, SliceFlow& o) {
  visit("mu", o.mu, OptionInfo{"as in gvf: large spreads the field and blurs what it tells", "", 1e-6, 1e4});
  visit("iterations", o.iterations, OptionInfo{"steps", "", 1, 100000});
}

/// LAB-SIGN (thesis 2.3.2): borders are where the vectors of a row or column meet. They are not told apart.
struct SignLabels {
  static constexpr std::string_view name = "sign";
  double least_change = 0.05;
  SliceFlow flow{};
};
void describe(auto& visit, SignLabels& o) {
  visit("least_change", o.least_change,
        OptionInfo{"smaller changes are noise (eps)", "of the slice's longest vector", 0, 1});
  visit("flow", o.flow, OptionInfo{"the field that is read"});
}

/// How LAB-GRADMAG and LAB-CASE find borders in a row or column of the field. A border seldom lies in the middle of a
/// pixel, and the field is not quiet half a pixel beside it: with `low` 0.15 half of the lines miss one of four.
struct QuietPoints {
  double low = 0.4;
  double high = 0.4;
  int width_px = 3;
  SliceFlow flow{};
};
void describe(auto& visit, QuietPoints& o) {
  visit("low", o.low, OptionInfo{"most length of a vector on the border", "of the slice's longest vector", 0, 1});
  visit("high", o.high, OptionInfo{"least length on both sides of it", "of the slice's longest vector", 0, 1});
  visit("width_px", o.width_px, OptionInfo{"how far from it", "px", 1, 50});
  visit("flow", o.flow, OptionInfo{"the field that is read"});
}

/// LAB-GRADMAG (thesis 2.3.3): borders are where the field is quiet between two strong sides. They are not told apart.
struct GradMagLabels {
  static constexpr std::string_view name = "gradmag";
  QuietPoints quiet{};
};
void describe(auto& visit, GradMagLabels& o) { visit("quiet", o.quiet, OptionInfo{"what is quiet"}); }

/// LAB-CASE (thesis 2.3.4): quiet points where vectors meet, told apart by their number along a row or column: four
/// are outer, inner, inner, outer; two are outer; none is nothing; of any other number nothing is said.
struct CaseLabels {
  static constexpr std::string_view name = "case";
  QuietPoints quiet{};
};
void describe(auto& visit, CaseLabels& o) { visit("quiet", o.quiet, OptionInfo{"what is quiet"}); }

/// LAB-RADIAL (thesis 2.3.5): edges counted in rings around the centre; the peaks are the borders.
struct RadialLabels {
  static constexpr std::string_view name = "radial";
  int ring_px = 1;
  double least_share = 0.15;
};
void describe(auto& visit, RadialLabels& o) {
  visit("ring_px", o.ring_px, OptionInfo{"width of a ring (delta; thesis 1, 2, 3)", "px", 1, 20});
  visit("least_share", o.least_share,
        OptionInfo{"a border has at least this share of a slice's edge pixels in its ring", "", 0, 1});
}

/// The methods that tell the inner border from the outer one.
using LabelOptions = std::variant<Mlc, NoLabels, SignLabels, GradMagLabels, CaseLabels, RadialLabels>;

/// What the image shows brightly: the muscle of the wall (perfusion), or the blood in the cavity (a blood pool).
enum class ImageContrast { automatic, wall, cavity };
inline std::span<const std::string_view> names_of(ImageContrast) {
  static constexpr std::array<std::string_view, 3> names{"auto", "wall", "cavity"};
  return names;
}

/// All of the labelling stage.
struct Labelling {
  ImageContrast bright = ImageContrast::automatic;
  CoarseCircle coarse;
  AutoCircle circle;
  DivisionSlice division;
  LabelOptions method = Mlc{};
};
void describe(auto& visit, Labelling& o) {
  visit("bright", o.bright,
        OptionInfo{
            "what is bright: wall (perfusion), cavity (blood pool: its rim is the inner border, and there is no outer "
            "one), or auto: what the image shows"});
  visit("coarse", o.coarse, OptionInfo{"coarse circle"});
  visit("circle", o.circle, OptionInfo{"automatic circle"});
  visit("division", o.division, OptionInfo{"division slice"});
  visit("method", o.method, OptionInfo{"labelling method"});
}

/// Where the two borders lie in one gate, slices apex first. Of a blood pool only the inner one is there. A voxel may
/// carry both bits: two borders pass through it, or the method cannot tell which one it is ("labels.not_told_apart").
struct Labels {
  static constexpr std::uint8_t endo_bit = 1, epi_bit = 2;
  Mask borders;                                // bits, per voxel
  Circle circle;                               // automatic circle: common to all slices
  Axis axis;                                   // centre of the ventricle in every slice
  int big_slice = -1;                          // slice of the widest circular border, -1: none found
  ImageContrast bright = ImageContrast::wall;  // what was taken to be bright, never automatic
  int division_slice = -1;                     // highest slice under the end of the cavity; -1: none found
  std::vector<std::optional<Circle>> local;    // the best circular edge of every slice, for drawing
  Notes notes;

  bool has(Border w) const;  // any voxel of that border
};

}  // namespace dynasurf::ventricle
