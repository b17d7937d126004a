#include "dynasurf/io/detail/dicom_places.hpp"

#include <cmath>
#include <numeric>

#include "dynasurf/core/error.hpp"

namespace dynasurf::io {

Placement placement_of(const DicomImage& image, Notes& notes) {
  if (!image.pixel_spacing)
    throw InputError(image.where() + ": PixelSpacing (0028,0030) is absent; expected the size of a pixel in mm");
  // PixelSpacing tells the distance between rows first, then that between columns, along a row.
  Placement p{Vec3::UnitX(),
              Vec3::UnitY(),
              Vec3::UnitZ(),
              Vec3::Zero(),
              image.pixel_spacing->second,
              image.pixel_spacing->first};
  if (image.orientation) {
    p.right = image.orientation->first;
    p.down = image.orientation->second;
    p.normal = p.right.cross(p.down);
  } else {
    note(notes, Severity::warning, "dicom.no_orientation",
         "ImageOrientationPatient is absent: the array's own axes are taken; where left and right are is not known");
  }
  if (image.position)
    p.origin = *image.position;
  else
    note(notes, Severity::info, "dicom.no_position", "ImagePositionPatient is absent: the first voxel is put at zero");
  return p;
}

double slice_spacing_of(const DicomImage& image, Notes& notes, bool several) {
  if (image.slice_spacing && *image.slice_spacing != 0) return *image.slice_spacing;
  if (image.slice_thickness && *image.slice_thickness > 0) {
    if (several)
      note(notes, Severity::warning, "dicom.slice_spacing",
           "SpacingBetweenSlices is absent: the slice thickness is taken instead");
    return *image.slice_thickness;
  }
  if (several)
    note(notes, Severity::warning, "dicom.slice_spacing",
         "SpacingBetweenSlices and SliceThickness are absent: slices are taken as far apart as pixels");
  return image.pixel_spacing->first;
}

void set_gate_times(DicomStack& stack, const DicomImage& image, int rr) {
  if (stack.gates < 2) return;
  // What the item of this R-R interval says is believed before what holds for the whole study.
  const auto at = static_cast<std::size_t>(rr) - 1;
  const auto value = [&](const std::vector<std::optional<double>>& values) {
    return at < values.size() && values[at] && *values[at] > 0 ? *values[at] : 0.0;
  };
  const double gates = stack.gates;
  double frame_ms = value(image.frame_time_of_rr);
  double cycle = value(image.nominal_interval_of_rr);
  // Time per slot is summed over all beats by the standard; some writers put the time within one beat there.
  if (frame_ms == 0 && cycle == 0 && at < image.slot_times_of_rr.size()) {
    const auto& slots = image.slot_times_of_rr[at];
    const double sum = std::accumulate(slots.begin(), slots.end(), 0.0);
    if (slots.size() == static_cast<std::size_t>(stack.gates) && sum >= 200 && sum <= 3000) frame_ms = sum / gates;
  }
  if (cycle == 0 && frame_ms > 0) cycle = frame_ms * gates;
  if (cycle == 0 && image.nominal_interval && *image.nominal_interval > 0) cycle = *image.nominal_interval;
  if (cycle == 0 && image.heart_rate && *image.heart_rate > 0) cycle = 60000 / *image.heart_rate;
  if (frame_ms == 0 && cycle > 0) frame_ms = cycle / gates;
  // 300 to 20 beats a minute; a unit that was mistaken, or a field that nobody filled in, falls outside.
  if (!(cycle >= 200 && cycle <= 3000) || !(frame_ms * gates <= 3000)) {
    note(stack.notes, Severity::info, "dicom.no_gate_times",
         "the times of the gates are not in the file or make no heart beat");
    return;
  }
  if (image.counts_back_from_r)
    note(stack.notes, Severity::info, "dicom.counts_back",
         "the gates were counted back from the R wave; their times are taken as forward");
  const double delay =
      image.trigger_time && *image.trigger_time >= 0 && *image.trigger_time < cycle ? *image.trigger_time : 0;
  stack.cycle_ms = cycle;
  for (int g = 0; g < stack.gates; ++g) stack.time_ms.push_back(delay + g * frame_ms);
}

const std::vector<GateKey>& gate_keys() {
  static const std::vector<GateKey> keys = {
      {"TriggerTime", [](const DicomImage& d) { return d.trigger_time; }},
      {"TemporalPositionIndex", [](const DicomImage& d) { return d.temporal_position; }},
      {"NominalPercentageOfCardiacPhase", [](const DicomImage& d) { return d.cycle_percentage; }}};
  return keys;
}

void set_times_from(DicomStack& stack, const std::string& key, const std::vector<double>& values,
                    const DicomImage& image) {
  const auto believable = [](double ms) { return ms >= 200 && ms <= 3000; };
  if (image.nominal_interval && believable(*image.nominal_interval))
    stack.cycle_ms = *image.nominal_interval;
  else if (image.heart_rate && *image.heart_rate > 0 && believable(60000 / *image.heart_rate))
    stack.cycle_ms = 60000 / *image.heart_rate;
  if (key == "TriggerTime" && values.front() >= 0 && values.back() <= 3000) {
    stack.time_ms = values;
    const double step = (values.back() - values.front()) / (values.size() - 1);
    if (stack.cycle_ms == 0 && believable(step * values.size())) stack.cycle_ms = step * values.size();
  } else if (stack.cycle_ms > 0) {
    for (std::size_t g = 0; g < values.size(); ++g)
      stack.time_ms.push_back(key == "NominalPercentageOfCardiacPhase"
                                  ? values[g] * stack.cycle_ms / 100
                                  : g * stack.cycle_ms / static_cast<double>(values.size()));
  }
}

}  // namespace dynasurf::io
