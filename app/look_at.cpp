#include "look_at.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace dynasurf::app {
namespace {

struct Advice {
  std::string_view codes;  // of flags, with a space around each
  std::string_view text;
};

// What explains others comes first: where no heart is found, all other flags follow from that.
constexpr std::array advices{
    Advice{" study.empty study.empty_gate normalise.empty ",
           "the file: it holds no positive value in all or some gates; was it exported whole?"},
    Advice{" blood_pool ", "the slices: if they show a wall and not the blood, --center x,y,z gives its middle"},
    Advice{" heart_not_found heart_uncertain fit.lost ",
           "the slices: if the surfaces are not in the ventricle, --center x,y,z gives its middle"},
    Advice{" orientation.ends_by_motion orientation.ends_by_shape orientation.ends_disagree ends_uncertain "
           "study.slice_order_unclear ",
           "apex and base: if they are exchanged, --axis x,y,z points from apex to base"},
    Advice{" orientation.uncertain orientation.reoriented ",
           "the long axis: if it leans, --axis x,y,z points from apex to base"},
    Advice{" surface_off_heart ", "the surfaces: if they leave the ventricle, --mask keeps to a region around it"},
    Advice{" hot_neighbour ", "where something hot touches the wall: --mask keeps to a region without it"},
    Advice{" surface_missing surface_diverged walls_cross counts_uneven study.same_gates study.counts_scaled ",
           "the gates that are named: if one is lost, --set manual.exclude_gates=N leaves it out"},
    Advice{" heart_moves curve_rough ",
           "the beating heart: --set manual.exclude_gates=N leaves a gate out in which it jumps"},
    Advice{" end_systole_implausible dicom.gate_order ", "the order of the gates and the volume curve"},
    Advice{" base_uncertain base_cut_off base.plane_missing base.cut_off ",
           "the valve plane: --set manual.base_shift_mm=MM moves it"},
    Advice{" heart_cut_off ", "the ends of the volume: a part of the wall lies outside"},
    Advice{" shape_implausible dicom.slice_spacing ", "the size of the voxels in the file, and the shape of the heart"},
    Advice{" thickness_implausible ", "the size of the voxels in the file; --fwhm gives the camera's width"},
    Advice{" edv_uncertain ef_uncertain fit.thickness_believed fit.thin_wall ",
           "the intervals: --fwhm or --set fit.thickness_mm=MM, where known, narrow them"},
};

bool is_about(const Advice& advice, const ventricle::QualityFlag& flag) {
  return flag.severity != Severity::info && advice.codes.find(" " + flag.code + " ") != std::string_view::npos;
}

}  // namespace

std::string look_at(const ventricle::Result& result) {
  if (result.verdict == ventricle::Verdict::ok) return {};
  const std::string& modality = result.study.modality;
  if (result.verdict == ventricle::Verdict::fail && (modality == "MR" || modality == "CT"))
    return "look at: the kind of image; a wall among other bright things is not found in " + modality +
           ": draw the muscle, and give the drawing as the study with --label N";
  for (const Advice& advice : advices)
    if (std::any_of(result.flags.begin(), result.flags.end(),
                    [&](const ventricle::QualityFlag& flag) { return is_about(advice, flag); }))
      return "look at: " + std::string(advice.text);
  return "look at: the borders of all gates in report.html";
}

}  // namespace dynasurf::app
