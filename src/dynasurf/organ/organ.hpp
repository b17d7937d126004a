#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/ventricle/detail/settle.hpp"
#include "dynasurf/ventricle/detail/surface.hpp"

namespace dynasurf::organ {

/// Where an organ is, other than a heart: liver, prostate, tumour (FUT-MODALITY). No circle, no division slice, no
/// base: one closed surface around the largest connected body.
enum class Source { between, of_maximum, labels };
inline std::span<const std::string_view> names_of(Source) {
  static constexpr std::array<std::string_view, 3> names{"between", "of_maximum", "labels"};
  return names;
}

/// Everything that `reconstruct` can be told.
struct Options {
  Source source = Source::between;
  double level = 0.5;
  bool dark = false;
  int label = 0;
  double smooth_voxels = 0;
  int mesh_level = 4;
  mesh::Placement placement{.scale = 1.2};
  field::FieldOptions field = field::SteadyGvf{};
  dynamics::Evolution evolution;
  ventricle::Settle settle{4, 1.5};
  mesh::Tidy tidy;
};
void describe(auto& visit, Options& o) {
  visit("source", o.source,
        OptionInfo{
            "between: values on the organ's side between the two usual values of the image (CT, MR); of_maximum: above "
            "a share of the largest (PET); labels: voxels of one value (label maps, masks)"});
  visit("level", o.level, OptionInfo{"where the organ begins: 0 the lower, 1 the upper value", "", 0.01, 0.99});
  visit("dark", o.dark, OptionInfo{"the organ is darker than what lies around it"});
  visit("label", o.label, OptionInfo{"its value in a label map; 0: all that is above 0", "", 0, 1e6});
  visit(
      "smooth_voxels", o.smooth_voxels,
      OptionInfo{"standard deviation of the smoothing before the steepest slope is looked for; at least 0.7 for labels",
                 "smallest voxel sides", 0, 5});
  visit("mesh_level", o.mesh_level, OptionInfo{"3, 4, 5: 642, 2562, 10242 vertices", "", 2, 6});
  visit("placement", o.placement, OptionInfo{"what the surface starts from"});
  visit("field", o.field, OptionInfo{"vector field of the border"});
  visit("evolution", o.evolution, OptionInfo{"the deformable model"});
  visit("settle", o.settle, OptionInfo{"from where particles stopped to the steepest slope"});
  visit("tidy", o.tidy, OptionInfo{"better triangles, and none that cut each other"});
}

/// Named sets: "ct", "mr", "pet", "labels". Throws OptionError with the choices for an unknown name.
std::span<const std::string_view> preset_names();
Options preset(std::string_view name);

/// The surface of an organ.
struct Result {
  std::optional<ventricle::Surface> surface;  // world frame; absent when there is nothing to surround
  double voxels_ml = 0;                       // of the body's voxels
  double threshold = 0;                       // value from which a voxel is the organ's
  Notes notes;                                // "organ.cut_off", "organ.parts", "organ.none"
};

/// The closed surface of the largest body of an image. Voxels of any spacing. Throws InputError for fewer than 3
/// slices, rows or columns or a value that is not finite, OptionError, Cancelled. The same bytes for any number of
/// threads.
Result reconstruct(const Image& image, const Options& options, const Progress& progress = {});

}  // namespace dynasurf::organ
