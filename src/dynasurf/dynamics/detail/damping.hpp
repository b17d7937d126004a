#pragma once
#include <functional>
#include <optional>
#include <string_view>
#include <variant>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/field/detail/field_view.hpp"

namespace dynasurf::dynamics {

// Maps of the drag (VOL-DAMP, thesis 3.4.2 and 6.1.2.3): kg/s per voxel, larger where the border is likely, so that
// particles brake there. They soften the oscillation about a border; only STOP-VOXEL ends it.

/// (a) by intensity: drag * (1 + ratio * I / max I); negative intensities count as 0.
Image drag_by_intensity(const Image& image, double drag, double ratio = 10);
/// (b) by the length of the field's vectors (STOP-DAMP): drag * (1 + ratio * |v| / max |v|). It brakes on the flanks of
/// the border, where the field is strong, not on it.
Image drag_by_field(field::FieldView field, double drag, double ratio = 10);
/// (c) near border voxels (STOP-HARDEN): drag * (1 + ratio * exp(-d / reach)), d the distance to the nearest non-zero
/// voxel's centre in voxels.
Image drag_near_border(const Image& border, double drag, double ratio = 10, double reach_voxels = 1);

/// The drag is the same everywhere.
struct UniformDrag {
  static constexpr std::string_view name = "uniform";
};
/// It is higher where the image is bright (a).
struct IntensityDrag {
  static constexpr std::string_view name = "intensity";
  double ratio = 10;
};
/// It is higher where the field is strong (b).
struct FieldDrag {
  static constexpr std::string_view name = "field";
  double ratio = 10;
};
/// It is higher near border voxels (c).
struct BorderDrag {
  static constexpr std::string_view name = "border";
  double ratio = 10;
  double reach_voxels = 1;
};
void describe(auto&, UniformDrag&) {}
void describe(auto& visit, IntensityDrag& o) {
  visit("ratio", o.ratio,
        OptionInfo{"drag added where the image is brightest and tissue most likely, in units of the drag", "", 0, 1e6});
}
void describe(auto& visit, FieldDrag& o) {
  visit("ratio", o.ratio, OptionInfo{"drag added where the field is strongest, in units of the drag", "", 0, 1e6});
}
void describe(auto& visit, BorderDrag& o) {
  visit("ratio", o.ratio, OptionInfo{"drag added on the border, in units of the drag", "", 0, 1e6});
  visit("reach_voxels", o.reach_voxels, OptionInfo{"distance in which it falls to 1/e", "voxels", 0.01, 1000});
}
/// One of the four.
using DampingOptions = std::variant<UniformDrag, IntensityDrag, FieldDrag, BorderDrag>;

/// The image on the field's grid, for IntensityDrag: made only where it is asked for.
using ImageOfDrag = std::function<Image()>;

/// The map that the options describe; none for a uniform drag. Throws OptionError for IntensityDrag without an image.
std::optional<Image> drag_map(const DampingOptions& options, field::FieldView field, const Image& border, double drag,
                              const ImageOfDrag& image = {});

}  // namespace dynasurf::dynamics
