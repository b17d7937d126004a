#include "look_at.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace dynasurf::app {
namespace {

struct Advice {
  std::string_view code;  // or its beginning
  std::string_view text;
};

// What explains others comes first: where no heart is found, all other flags follow from that.
constexpr std::array advices{
    Advice{"study.empty", "the file: it holds no positive value in all or some gates; was it exported whole?"},
    Advice{"blood_pool", "the slices: if they show a wall and not the blood, --center x,y,z gives its middle"},
    Advice{"heart_not_found", "the slices: if you see the ventricle, --center x,y,z gives its middle"},
    Advice{"heart_uncertain", "the cross: if it is not in the ventricle, --center x,y,z gives its middle"},
    Advice{"orientation.", "apex and base: if they are exchanged, --axis x,y,z points from apex to base"},
    Advice{"ends_uncertain", "apex and base: if they are exchanged, --axis x,y,z points from apex to base"},
    Advice{"surface_off_heart", "the surfaces: if they leave the ventricle, --mask keeps to a region around it"},
    Advice{"hot_neighbour", "where something hot touches the wall: --mask keeps to a region without it"},
    Advice{"surface_", "the gates that are named: if one is lost, --set manual.exclude_gates=N leaves it out"},
    Advice{"counts_uneven", "the gates that are named: --set manual.exclude_gates=N leaves one out"},
    Advice{"study.", "the gates that are named: --set manual.exclude_gates=N leaves one out"},
    Advice{"heart_moves", "the beating heart: --set manual.exclude_gates=N leaves gates out in which it jumps"},
    Advice{"curve_rough", "the volume curve: --set manual.exclude_gates=N leaves a gate out"},
    Advice{"end_systole_implausible", "the order of the gates and the volume curve"},
    Advice{"base_", "the valve plane: --set manual.base_shift_mm=MM moves it"},
    Advice{"heart_cut_off", "the ends of the volume: a part of the wall lies outside"},
    Advice{"shape_implausible", "the size of the voxels in the file, and the shape of the heart"},
    Advice{"thickness_implausible", "the size of the voxels in the file; --fwhm gives the camera's width"},
    Advice{"edv_uncertain", "the intervals: --fwhm or --set fit.thickness_mm=MM, where known, narrow them"},
    Advice{"ef_uncertain", "the intervals: --fwhm or --set fit.thickness_mm=MM, where known, narrow them"},
    Advice{"fit.", "the intervals: --fwhm or --set fit.thickness_mm=MM, where known, narrow them"},
};

}  // namespace

std::string look_at(const ventricle::Result& result) {
  if (result.verdict == ventricle::Verdict::ok) return {};
  const std::string& modality = result.study.modality;
  if (result.verdict == ventricle::Verdict::fail && (modality == "MR" || modality == "CT"))
    return "look at: the kind of image; walls of " + modality +
           " among other bright things are not found: draw the muscle, and give the drawing as the study with --label "
           "N";
  for (const Advice& advice : advices)
    if (std::any_of(result.flags.begin(), result.flags.end(), [&](const ventricle::QualityFlag& flag) {
          return flag.severity != Severity::info && flag.code.starts_with(advice.code);
        }))
      return "look at: " + std::string(advice.text);
  return "look at: the borders of all gates in report.html";
}

}  // namespace dynasurf::app
