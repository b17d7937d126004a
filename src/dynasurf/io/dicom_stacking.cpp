#include "dynasurf/io/detail/dicom_stacking.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_places.hpp"

namespace dynasurf::io {

bool is_same_grid(const Grid& a, const Grid& b) {
  return a.dims == b.dims && (a.spacing - b.spacing).norm() < 1e-3 && (a.origin - b.origin).norm() < same_place_mm &&
         (a.direction - b.direction).norm() < 1e-3;
}

std::string reason_to_refuse(const DicomImage& image) {
  const std::string& kind = image.kind();
  if (image.sop_class.rfind("1.2.840.10008.5.1.4.1.1.", 0) == 0) {
    // Storage classes: Enhanced MR, CT, PET and MR Color and Legacy Converted Enhanced CT, MR and PET keep the places
    // of their frames in functional groups; 7 and its kin are Secondary Capture.
    const std::string of = image.sop_class.substr(24);
    if (of == "4.1" || of == "2.1" || of == "130" || of == "4.3" || of == "2.2" || of == "4.4" || of == "128.1")
      return "is an Enhanced multi-frame image, which is not read; convert it to single-frame files or NIfTI first";
    if (of == "7" || of.rfind("7.", 0) == 0)
      return "is a screen capture, not image data; give the reconstructed slices";
  }
  if (image.samples != 1) return "is a colour picture, not image data; give the reconstructed slices";
  // In nuclear medicine value 3 of ImageType names the kind of image; a study without it may be anything.
  if (image.modality == "NM") {
    if (kind == "RECON TOMO" || kind == "RECON GATED TOMO") return "";
    if (kind == "TOMO" || kind == "GATED TOMO")
      return "holds " + std::string(kind == "TOMO" ? "" : "gated ") + "projections (" + kind +
             "), not slices: reconstruct the projections first and reorient them to the short axis";
    if (kind == "STATIC" || kind == "WHOLE BODY" || kind == "DYNAMIC" || kind == "GATED")
      return "is a planar " + kind +
             " acquisition, which has no depth; expected a reconstructed stack (RECON GATED TOMO)";
    return "does not say in value 3 of ImageType what it is; expected RECON GATED TOMO or RECON TOMO";
  }
  if (image.modality != "PT" && image.modality != "MR" && image.modality != "CT")
    return "is not of modality NM, PT, MR or CT; expected a reconstructed heart study";
  if (kind == "LOCALIZER") return "is a localizer, not a stack of slices";
  if (image.is_reprojection || kind == "REPROJECTION" || kind == "PROJECTION IMAGE" || kind == "MIP")
    return "holds projections, not slices; give the reconstructed slices";
  if (image.frames > 1)
    return "is a multi-frame " + image.modality + " image of an unknown kind; convert it to single-frame files first";
  return "";
}

std::optional<DicomStack> joined_gates(const std::vector<DicomImage>& images, std::span<const DicomStack> stacks) {
  const auto image = [&](const DicomStack& s) -> const DicomImage& { return images[s.first_file()]; };
  for (const DicomStack& s : stacks)
    if (s.gates != 1 || !is_same_grid(s.grid, stacks.front().grid) || image(s).study != image(stacks.front()).study ||
        image(s).kind() != image(stacks.front()).kind())
      return std::nullopt;

  std::vector<std::size_t> order(stacks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::pair<std::string, std::function<std::optional<double>(const DicomStack&)>>> keys;
  keys.emplace_back("TimeSlotVector", [](const DicomStack& s) {
    return s.only_gate ? std::optional<double>(*s.only_gate) : std::nullopt;
  });
  for (const GateKey& key : gate_keys())
    keys.emplace_back(key.name, [&, key](const DicomStack& s) { return key.value(image(s)); });
  keys.emplace_back("SeriesDescription", [&](const DicomStack& s) {
    const auto& n = image(s).gate_in_words;
    return n ? std::optional<double>(*n) : std::nullopt;
  });
  // The first attribute that every stack has, and no two alike, orders the gates; the surest is asked first.
  for (const auto& [name, value] : keys) {
    std::map<double, std::size_t> by_value;
    for (std::size_t n = 0; n < stacks.size(); ++n)
      if (const auto v = value(stacks[n])) by_value.emplace(*v, n);
    if (by_value.size() != stacks.size()) continue;
    DicomStack whole = stacks.front();
    whole.frames.clear();
    whole.gates = stacks.size();
    std::vector<double> values;
    for (const auto& [v, n] : by_value) {
      values.push_back(v);
      whole.frames.insert(whole.frames.end(), stacks[n].frames.begin(), stacks[n].frames.end());
    }
    // Numbers that count gates tell of a missing file by a gap; times and percentages may be spaced as they like.
    const bool counted = name == "TimeSlotVector" || name == "SeriesDescription";
    const int declared = stacks.front().declared_gates;
    if (counted &&
        (values.back() - values.front() != (values.size() - 1) || (name == "TimeSlotVector" && declared > whole.gates)))
      throw InputError(
          image(stacks.front()).path.parent_path().string() + ": the files hold " + std::to_string(stacks.size()) +
          " gates, numbered " + std::to_string(static_cast<int>(values.front())) + " to " +
          std::to_string(static_cast<int>(std::max<double>(values.back(), declared))) + "; a gate is missing");
    whole.declared_gates = whole.gates;
    whole.only_gate.reset();
    if (name == "SeriesDescription")
      note(whole.notes, Severity::warning, "dicom.gate_order",
           "the gates are ordered by the numbers in their series descriptions");
    // The header of one gate tells the beat, which is divided evenly; trigger times that differ from gate to gate are
    // the gates' own and better.
    set_gate_times(whole, image(stacks.front()), 1);
    if (whole.time_ms.empty() || name == "TriggerTime") {
      whole.time_ms.clear();
      std::erase_if(whole.notes, [](const Note& n) { return n.code == "dicom.no_gate_times"; });
      set_times_from(whole, name, values, image(stacks.front()));
    }
    return whole;
  }
  return std::nullopt;
}

}  // namespace dynasurf::io
