#include <array>

#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/ventricle/options.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr std::array<std::string_view, 6> names{"psf_corrected", "edges", "thesis", "pet", "mr", "ct"};

/// Surfaces on the largest gradient alone.
Options edge_options() {
  Options o;
  o.fit.run = false;
  return o;
}

/// The run over a cardiac cycle of thesis 6.3 (CARD-CYCLE): Canny's parameters of 6.1.4, the labels decided by the
/// largest gap alone, explicit fields, particles that stop at the faces of border voxels, drag of 1 %, a step of 0.1 s,
/// straight lines between the gates, surfaces that end at a slice.
Options thesis_options() {
  Options o = edge_options();
  o.orientation.method = OrientationMethod::header;
  o.closure.valve_plane = false;
  o.edges = image::Canny{.sigma_px = 1.8, .low = 0.3, .high = 0.7};
  o.labels.bright = ImageContrast::wall;
  o.labels.circle = {.min_component_px = 8, .centroid_tolerance_px = 1, .robust_fit = false};
  o.labels.method = Mlc{.strict_thesis = true, .box_margin_px = 0};
  o.field = field::Gvf{};
  o.evolution.stop.point = dynamics::StopPoint::entry;
  o.settle.rounds = 0;
  o.evolution.force.drag = 0.01;
  o.evolution.step_s = 0.1;
  o.evolution.end.still_radius = 0;
  o.keyframes.interpolation = mesh::TimeInterpolation::linear;
  return o;
}

/// PET is sharper than SPECT, how much depends on scanner and filter: the data decide.
Options pet_options() {
  Options o;
  o.fit.fwhm_mm = 6;
  o.fit.fwhm_uncertainty = 0.25;
  return o;
}

/// MR and CT, as grey images of the muscle and as masks of it, are sharp.
Options sharp_options() {
  Options o;
  o.fit.fwhm_mm = 0;
  return o;
}

}  // namespace

std::span<const std::string_view> preset_names() { return names; }

Options preset(std::string_view name) {
  switch (position_of(names, name, "preset")) {
    case 1:
      return edge_options();
    case 2:
      return thesis_options();
    case 3:
      return pet_options();
    case 4:
    case 5:
      return sharp_options();
    default:
      return {};
  }
}

}  // namespace dynasurf::ventricle
