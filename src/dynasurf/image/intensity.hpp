#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::image {

/// Divides by the largest value of the volume (VOL-NORM, thesis 6.1): the maximum becomes exactly 1. Negative values
/// stay. A volume without a positive value is returned as it is, with a note "normalise.empty".
Image normalise(Image image, Notes& notes);

/// The other reading of VOL-NORM: (I - min) / (max - min) over all the images together, so that the least value of the
/// data becomes exactly 0 and the largest exactly 1. Images that hold one value only stay, with a note
/// "normalise.flat".
void stretch_to_range(std::span<Image> images, Notes& notes);

/// Sets values below `fraction` of the maximum to 0 (VOL-NOISE20, thesis 6.1.2.5); 0 keeps all. Throws OptionError
/// unless 0 <= fraction <= 1.
Image suppress_noise(Image image, double fraction);

/// 1 where the value is at least `level`, else 0 (VOL-THRESH, thesis 6.1). The thesis advises against it for
/// measuring: the right level is another for every patient.
Image threshold_at(Image image, double level);

/// How the lost figure 2.4 is read: the centre weighs 2.5 and the neighbourhood 1.5 of 4.
enum class DoublingMask {
  three,   // 0.5 on each of the three neighbours of the quadrant: ramps stay ramps
  single,  // 1.5 on the diagonal neighbour
};
std::span<const std::string_view> names_of(DoublingMask);

/// Twice the voxels along every axis (VOL-DOUBLE, thesis 2.2.1): the mask within the slices, 3:1 between them. The
/// sum of the values grows eightfold up to the border. The thesis rejects it: edges weaken, and nothing is gained.
Image double_resolution(const Image& image, DoublingMask mask = DoublingMask::three);

/// The circle of VOL-PROPCUT.
struct PropertyCut {
  double x_px = 0, y_px = 0, radius_px = 1;
  bool soft = false;
  double band_px = 2;
  double sigma_px = 1;
};

/// Values outside the circle set to 0 in every slice (VOL-PROPCUT, thesis 2.4). With `soft` the pixels within
/// `band_px` of the circle are then smoothed by a Gaussian. The thesis rejects both: the cut itself becomes an edge.
/// Throws OptionError for a negative radius, band or width.
Image cut_property(Image image, const PropertyCut& cut);

/// What the thesis tried on the values before it looked for edges, and gave up. Nothing of it is done by default.
struct Preparation {
  enum class Doubling { none, three, single };
  bool from_least = false;
  Doubling doubling = Doubling::none;
  std::optional<double> threshold;
  std::optional<double> cut_radius_px, cut_x_px, cut_y_px;
  bool soft_cut = false;
};
inline std::span<const std::string_view> names_of(Preparation::Doubling) {
  static constexpr std::array<std::string_view, 3> names{"none", "three", "single"};
  return names;
}
void describe(auto& visit, Preparation& o) {
  visit("from_least", o.from_least,
        OptionInfo{"normalise by (I - min) / (max - min) over all gates in place of I / max (VOL-NORM)"});
  visit("doubling", o.doubling,
        OptionInfo{"double the resolution (VOL-DOUBLE); three or single: where the mask's weight of 1.5 lies"});
  visit("threshold", o.threshold,
        OptionInfo{"make the data binary: 1 from this share of the maximum on (VOL-THRESH)", "of the maximum", 0, 1});
  visit("cut_radius_px", o.cut_radius_px,
        OptionInfo{"set what lies outside a circle to 0 (VOL-PROPCUT)", "px", 1, 10000});
  visit("cut_x_px", o.cut_x_px, OptionInfo{"its centre, column; unset: the middle", "px"});
  visit("cut_y_px", o.cut_y_px, OptionInfo{"its centre, row; unset: the middle", "px"});
  visit("soft_cut", o.soft_cut, OptionInfo{"smooth along the circle"});
}

/// Cuts, then doubles, then thresholds a normalised volume, as far as asked for. Pixels are those of `image`. What
/// concerns all gates at once, `from_least`, is not done here: see `stretch_to_range`.
Image prepare(Image image, const Preparation& options);

/// Value at a point of the grid frame (mm) by linear interpolation. Outside the grid the nearest value inside stands.
double sample_linear(const Image& image, const Vec3& grid_mm);

/// The same by cubic interpolation (Keys, a = -1/2): exact for parabolas, so it does not blur as linear does.
double sample_cubic(const Image& image, const Vec3& grid_mm);

/// The image at the voxels of another grid, by one cubic interpolation; 0 where a voxel lies more than half a voxel
/// outside `image`. A non-negative image stays non-negative: overshoot below 0 is cut.
/// Both grids are placed in the world. Structures finer than the new voxels are not filtered out.
Image resample(const Image& image, const Grid& grid);

/// Gaussian of standard deviation `sigma_mm` along every axis, borders replicated; 0 returns the image.
Image smooth_gaussian(const Image& image, double sigma_mm);

}  // namespace dynasurf::image
