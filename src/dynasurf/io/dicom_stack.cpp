#include "dynasurf/io/detail/dicom_stack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numeric>
#include <set>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_whole.hpp"
#include "dynasurf/io/detail/dicom_words.hpp"
#include "dynasurf/io/detail/samples.hpp"

namespace dynasurf::io {
namespace {

void note(Notes& notes, Severity severity, const std::string& code, const std::string& message) {
  notes.push_back({severity, code, message});
}

/// Signed distance between slices: SpacingBetweenSlices, else the thickness, else the spacing within the slice.
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

struct Placement {
  Vec3 right, down, normal, origin;
  double column_mm, row_mm;
};

Placement placement_of(const DicomImage& image, Notes& notes) {
  if (!image.pixel_spacing)
    throw InputError(image.where() + ": PixelSpacing (0028,0030) is absent; expected the size of a pixel in mm");
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

void check_entries(const std::vector<int>& entries, const DicomImage& image, int most, const char* name) {
  if (entries.size() != static_cast<std::size_t>(image.frames))
    throw InputError(image.where() + ": " + name + " has " + std::to_string(entries.size()) + " entries for " +
                     std::to_string(image.frames) + " frames");
  for (std::size_t f = 0; f < entries.size(); ++f)
    if (entries[f] < 1 || entries[f] > most)
      throw InputError(image.where() + ": entry " + std::to_string(f + 1) + " of " + name + " is " +
                       std::to_string(entries[f]) + "; expected 1 to " + std::to_string(most));
}

int largest(const std::vector<int>& entries) {
  return entries.empty() ? 0 : *std::max_element(entries.begin(), entries.end());
}

/// The vectors that say what each frame is, counted from 1.
struct FrameVectors {
  std::optional<std::vector<int>> rr, gate, slice;
};

/// A vector of the file. Some writers count from 0: told by an entry of 0, where one more for each still fits what is
/// declared.
std::optional<std::vector<int>> counted_from_one(std::optional<std::vector<int>> entries,
                                                 const std::optional<int>& declared, const char* name, Notes& notes) {
  if (!entries || entries->empty() || *std::min_element(entries->begin(), entries->end()) != 0) return entries;
  if (declared && largest(*entries) >= *declared) return entries;
  for (int& entry : *entries) ++entry;
  note(notes, Severity::info, "dicom.counts_from_zero",
       std::string(name) + " counts from 0; expected from 1: each entry is taken as one more");
  return entries;
}

FrameVectors vectors_of(const DicomImage& image, Notes& notes) {
  return {counted_from_one(image.rr_of_frame, image.rr_count, "RRIntervalVector", notes),
          counted_from_one(image.gate_of_frame, image.gate_count, "TimeSlotVector", notes),
          counted_from_one(image.slice_of_frame, image.slice_count, "SliceVector", notes)};
}

std::string words_of(const EnergyRange& range) {
  std::array<char, 60> text{};
  std::snprintf(text.data(), text.size(), "%.4g to %.4g keV", range.lower, range.upper);
  return text.data();
}

/// Of several energy windows the one that holds the nuclide's peak; where none or more than one is told to hold it, of
/// these the one with most counts. `windows` are the numbers the frames bear.
int photopeak_window(const DicomImage& image, const std::set<int>& windows, Notes& notes) {
  const double peak = photopeak_kev(image.isotope);
  const int first = *windows.begin() == 0 ? 0 : 1;  // some writers count from 0
  const auto ranges_of = [&](int window) -> std::span<const EnergyRange> {
    const auto at = static_cast<std::size_t>(window - first);
    return window >= first && at < image.windows.size() ? image.windows[at] : std::span<const EnergyRange>();
  };
  std::set<int> holding;
  for (const int w : windows)
    for (const EnergyRange& range : ranges_of(w))
      if (range.lower <= peak && peak <= range.upper) holding.insert(w);
  std::string why = "that of the photopeak";
  int best = holding.empty() ? 0 : *holding.begin();
  if (holding.size() != 1) {
    std::map<int, double> counts;
    for (const int w : holding.empty() ? windows : holding) counts[w] = 0;
    read_dicom_frames(image, [&](int frame, std::span<const float> values) {
      const auto at = counts.find((*image.window_of_frame)[static_cast<std::size_t>(frame)]);
      if (at != counts.end()) at->second = std::accumulate(values.begin(), values.end(), at->second);
    });
    best = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
             return a.second < b.second;
           })->first;
    why = "with the most counts";
  }
  const auto ranges = ranges_of(best);
  note(notes, Severity::info, "dicom.energy_windows",
       "the study has " + std::to_string(windows.size()) + " energy windows; only number " + std::to_string(best) +
           " is read, " + why + (ranges.empty() ? "" : " (" + words_of(ranges.front()) + ")"));
  return best;
}

/// The energy window to read of each frame's; nothing where all frames have one.
std::optional<int> chosen_window(const DicomImage& image, Notes& notes, int& count) {
  count = 1;
  if (!image.window_of_frame) return std::nullopt;
  const std::set<int> windows(image.window_of_frame->begin(), image.window_of_frame->end());
  if (windows.size() < 2) return std::nullopt;
  count = static_cast<int>(windows.size());
  return photopeak_window(image, windows, notes);
}

/// Of several intervals between R waves, the one with most accepted beats, counted from 1.
int chosen_rr(const DicomImage& image, int count, Notes& notes) {
  if (count == 1) return 1;
  int best = 1, most = -1;
  for (std::size_t n = 0; n < image.beats_of_rr.size() && n < static_cast<std::size_t>(count); ++n)
    if (image.beats_of_rr[n] && *image.beats_of_rr[n] > most) {
      most = *image.beats_of_rr[n];
      best = static_cast<int>(n) + 1;
    }
  note(notes, Severity::warning, "dicom.rr_intervals",
       "the study has " + std::to_string(count) + " R-R intervals; only number " + std::to_string(best) + " is read" +
           (most >= 0 ? ", with the most accepted beats (" + std::to_string(most) + ")"
                      : ": the beats of each are not in the file"));
  return best;
}

void set_gate_times(DicomStack& stack, const DicomImage& image, int rr) {
  if (stack.gates < 2) return;
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

std::string pair_text(int gate, int slice) {
  return "gate " + std::to_string(gate + 1) + ", slice " + std::to_string(slice + 1);
}

struct Key {
  const char* name;
  std::function<std::optional<double>(const DicomImage&)> value;
};

const std::vector<Key>& gate_keys() {
  static const std::vector<Key> keys = {
      {"TriggerTime", [](const DicomImage& d) { return d.trigger_time; }},
      {"TemporalPositionIndex", [](const DicomImage& d) { return d.temporal_position; }},
      {"NominalPercentageOfCardiacPhase", [](const DicomImage& d) { return d.cycle_percentage; }}};
  return keys;
}

/// Times from trigger times in ms or from percentages of the cycle.
void set_times_from(DicomStack& stack, const std::string& key, const std::vector<double>& values,
                    const DicomImage& image) {
  const auto believable = [](double ms) { return ms >= 200 && ms <= 3000; };
  if (image.nominal_interval && believable(*image.nominal_interval))
    stack.cycle_ms = *image.nominal_interval;
  else if (image.heart_rate && *image.heart_rate > 0 && believable(60000 / *image.heart_rate))
    stack.cycle_ms = 60000 / *image.heart_rate;
  if (key == "TriggerTime" && values.front() >= 0 && values.back() <= 3000) {
    stack.time_ms = values;
    const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
    if (stack.cycle_ms == 0 && believable(step * static_cast<double>(values.size())))
      stack.cycle_ms = step * static_cast<double>(values.size());
  } else if (stack.cycle_ms > 0) {
    for (std::size_t g = 0; g < values.size(); ++g)
      stack.time_ms.push_back(key == "NominalPercentageOfCardiacPhase"
                                  ? values[g] * stack.cycle_ms / 100
                                  : static_cast<double>(g) * stack.cycle_ms / static_cast<double>(values.size()));
  }
}

}  // namespace

bool is_same_grid(const Grid& a, const Grid& b) {
  return a.dims == b.dims && (a.spacing - b.spacing).norm() < 1e-3 && (a.origin - b.origin).norm() < same_place_mm &&
         (a.direction - b.direction).norm() < 1e-3;
}

std::string reason_to_refuse(const DicomImage& image) {
  const std::string& kind = image.kind();
  if (image.sop_class.rfind("1.2.840.10008.5.1.4.1.1.", 0) == 0) {
    const std::string of = image.sop_class.substr(24);
    if (of == "4.1" || of == "2.1" || of == "130" || of == "4.3" || of == "128.1")
      return "is an Enhanced multi-frame image, which is not read; convert it to single-frame files or NIfTI first";
    if (of == "7" || of.rfind("7.", 0) == 0)
      return "is a screen capture, not image data; give the reconstructed slices";
  }
  if (image.samples != 1) return "is a colour picture, not image data; give the reconstructed slices";
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

DicomStack stack_of_frames(const DicomImage& image, std::size_t file) {
  DicomStack stack;
  const int frames = image.frames;
  std::vector<int> gate(static_cast<std::size_t>(frames), 1), slice = gate, rr = gate;

  const FrameVectors vectors = vectors_of(image, stack.notes);
  const int rr_count = image.rr_count.value_or(vectors.rr ? largest(*vectors.rr) : 1);
  if (vectors.rr)
    check_entries(rr = *vectors.rr, image, rr_count, "RRIntervalVector");
  else if (rr_count != 1)
    throw InputError(image.where() + ": has " + std::to_string(rr_count) + " R-R intervals but no RRIntervalVector");

  const bool gated = image.kind() == "RECON GATED TOMO" || vectors.gate;
  int gates = gated ? image.gate_count.value_or(vectors.gate ? largest(*vectors.gate) : 0) : 1;
  int slices = image.slice_count.value_or(vectors.slice ? largest(*vectors.slice) : 0);
  int windows = 1;
  const auto window_kept = chosen_window(image, stack.notes, windows);
  const int per_rr = frames / std::max(rr_count, 1) / windows;
  if (slices == 0) slices = gates > 0 ? per_rr / gates : 0;
  if (gates == 0) gates = slices > 0 ? per_rr / slices : 0;
  if (slices < 1 || gates < 1)
    throw InputError(image.where() + ": says neither how many gates nor how many slices its " + std::to_string(frames) +
                     " frames are");

  if (!vectors.slice || (gated && !vectors.gate)) {
    // Without a vector the frames count slices first, then gates.
    if (static_cast<long long>(gates) * slices != frames || rr_count != 1 || window_kept)
      throw InputError(image.where() + ": has no SliceVector or TimeSlotVector, and " + std::to_string(frames) +
                       " frames are not " + std::to_string(gates) + " gates of " + std::to_string(slices) + " slices");
    note(stack.notes, Severity::info, "dicom.no_frame_vectors",
         "the order of the frames is assumed: all slices of a gate, then the next gate");
    for (int f = 0; f < frames; ++f) {
      gate[static_cast<std::size_t>(f)] = f / slices + 1;
      slice[static_cast<std::size_t>(f)] = f % slices + 1;
    }
  }
  if (vectors.slice) check_entries(slice = *vectors.slice, image, slices, "SliceVector");
  if (vectors.gate)
    check_entries(gate = *vectors.gate, image, std::max(gates, largest(*vectors.gate)), "TimeSlotVector");

  // A file that holds one gate of several numbers its frames by that gate.
  const bool is_one_gate = vectors.gate && std::set<int>(gate.begin(), gate.end()).size() == 1;
  if (is_one_gate && (image.gate_of_frame->front() != 1 || gates > 1)) {
    stack.only_gate = image.gate_of_frame->front();
    stack.declared_gates = std::max(gates, gate[0]);
    gates = 1;
    std::fill(gate.begin(), gate.end(), 1);
  }
  if (largest(gate) > gates)
    throw InputError(image.where() + ": TimeSlotVector counts to " + std::to_string(largest(gate)) +
                     ", NumberOfTimeSlots says " + std::to_string(gates));

  check_study_size(static_cast<std::uint64_t>(image.columns), static_cast<std::uint64_t>(image.rows),
                   static_cast<std::uint64_t>(slices), static_cast<std::uint64_t>(gates), image.where());
  const int rr_kept = chosen_rr(image, rr_count, stack.notes);
  const std::size_t places = static_cast<std::size_t>(gates) * static_cast<std::size_t>(slices);
  if (places > static_cast<std::size_t>(frames))
    throw InputError(image.where() + ": " + std::to_string(frames) + " frames cannot be " + std::to_string(gates) +
                     " gates of " + std::to_string(slices) + " slices: some (gate, slice) pair is missing");
  std::vector<int> frame_at(places, -1);
  for (int f = 0; f < frames; ++f) {
    const auto n = static_cast<std::size_t>(f);
    if (rr[n] != rr_kept || (window_kept && (*image.window_of_frame)[n] != *window_kept)) continue;
    int& at = frame_at[static_cast<std::size_t>(gate[n] - 1) * static_cast<std::size_t>(slices) +
                       static_cast<std::size_t>(slice[n] - 1)];
    if (at >= 0)
      throw InputError(image.where() + ": frames " + std::to_string(at + 1) + " and " + std::to_string(f + 1) +
                       " are both " + pair_text(gate[n] - 1, slice[n] - 1));
    at = f;
  }
  for (std::size_t p = 0; p < places; ++p) {
    if (frame_at[p] < 0)
      throw InputError(image.where() + ": no frame is " +
                       pair_text(static_cast<int>(p) / slices, static_cast<int>(p) % slices));
    stack.frames.push_back({file, frame_at[p]});
  }

  stack.gates = gates;
  const Placement place = placement_of(image, stack.notes);
  const double spacing = slice_spacing_of(image, stack.notes, slices > 1);
  Mat3 steps;
  // The sign of the spacing is kept: the grid is left-handed then.
  steps << place.right * place.column_mm, place.down * place.row_mm, place.normal * spacing;
  stack.grid = grid_from_steps({image.columns, image.rows, slices}, steps, place.origin, image.where());
  set_gate_times(stack, image, rr_kept);
  return stack;
}

DicomStack stack_of_slices(const std::vector<DicomImage>& images, std::span<const std::size_t> files) {
  DicomStack stack;
  const DicomImage& first = images[files.front()];
  const Placement place = placement_of(first, stack.notes);
  std::set<std::string> instances;
  std::map<std::size_t, double> height;
  for (const std::size_t f : files) {
    const DicomImage& image = images[f];
    if (!image.sop_instance.empty() && !instances.insert(image.sop_instance).second)
      throw InputError(image.where() + ": is there twice: another file of this folder holds the same image");
    if (image.position)
      height[f] = place.normal.dot(*image.position);
    else if (image.slice_location)
      height[f] = *image.slice_location;
    else if (files.size() == 1)
      height[f] = 0;
    else
      throw InputError(image.where() +
                       ": has neither ImagePositionPatient nor SliceLocation, so its place in the stack is not known");
  }

  // Files of one place, lowest first.
  std::vector<std::size_t> order(files.begin(), files.end());
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return height[a] < height[b]; });
  std::vector<std::vector<std::size_t>> slices;
  for (const std::size_t f : order) {
    if (slices.empty() || height[f] - height[slices.back().front()] > same_place_mm) slices.emplace_back();
    slices.back().push_back(f);
  }
  const std::size_t gates = std::max_element(slices.begin(), slices.end(), [](const auto& a, const auto& b) {
                              return a.size() < b.size();
                            })->size();
  for (std::size_t k = 0; k < slices.size(); ++k)
    if (slices[k].size() != gates)
      throw InputError(first.path.parent_path().string() + ": slice " + std::to_string(k + 1) + " of " +
                       std::to_string(slices.size()) + ", at " + std::to_string(height[slices[k].front()]) +
                       " mm along the normal, has " + std::to_string(slices[k].size()) + " images, another " +
                       std::to_string(gates) + "; a file is missing or double");
  require_all_images(images, files, slices.size(), gates, stack.notes);

  if (gates > 1) {
    std::string used;
    std::vector<Key> keys = gate_keys();
    keys.push_back({"InstanceNumber", [](const DicomImage& d) {
                      return d.instance_number ? std::optional<double>(*d.instance_number) : std::nullopt;
                    }});
    for (const Key& key : keys) {
      const auto value = [&](std::size_t f) { return key.value(images[f]); };
      const bool tells_apart = std::all_of(slices.begin(), slices.end(), [&](const auto& slice) {
        std::set<double> seen;
        for (const std::size_t f : slice)
          if (!value(f) || !seen.insert(*value(f)).second) return false;
        return true;
      });
      if (!tells_apart) continue;
      used = key.name;
      std::vector<double> mean(gates, 0);
      for (auto& slice : slices) {
        std::sort(slice.begin(), slice.end(), [&](std::size_t a, std::size_t b) { return *value(a) < *value(b); });
        for (std::size_t g = 0; g < gates; ++g) mean[g] += *value(slice[g]) / static_cast<double>(slices.size());
      }
      if (used == "InstanceNumber")
        note(stack.notes, Severity::warning, "dicom.gate_order",
             "only the instance numbers tell the gates apart; their order is assumed");
      set_times_from(stack, used, mean, first);
      break;
    }
    if (used.empty())
      throw InputError(first.path.parent_path().string() + ": every slice has " + std::to_string(gates) +
                       " images, but nothing tells which gate each is (TriggerTime, TemporalPositionIndex, "
                       "NominalPercentageOfCardiacPhase)");
  }

  const std::size_t nz = slices.size();
  check_study_size(static_cast<std::uint64_t>(first.columns), static_cast<std::uint64_t>(first.rows), nz, gates,
                   first.where());
  Vec3 step = place.normal * std::abs(slice_spacing_of(first, stack.notes, false));
  const std::size_t bottom = slices.front().front(), top = slices.back().front();
  if (nz > 1) {
    const double mean = (height[top] - height[bottom]) / static_cast<double>(nz - 1);
    std::vector<double> heights;
    for (const auto& slice : slices) heights.push_back(height[slice.front()]);
    require_even_slices(heights, first.path.parent_path().string());
    step = images[bottom].position && images[top].position
               ? Vec3((*images[top].position - *images[bottom].position) / static_cast<double>(nz - 1))
               : Vec3(place.normal * mean);
  } else {
    note(stack.notes, Severity::warning, "dicom.one_slice",
         "there is one slice only; give the folder that holds the whole stack");
  }
  Mat3 steps;
  steps << place.right * place.column_mm, place.down * place.row_mm, step;
  stack.grid = grid_from_steps({first.columns, first.rows, static_cast<int>(nz)}, steps,
                               images[bottom].position.value_or(place.origin), first.where());
  stack.gates = static_cast<int>(gates);
  for (std::size_t g = 0; g < gates; ++g)
    for (const auto& slice : slices) stack.frames.push_back({slice[g], 0});
  return stack;
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
  for (const Key& key : gate_keys())
    keys.emplace_back(key.name, [&, key](const DicomStack& s) { return key.value(image(s)); });
  keys.emplace_back("SeriesDescription", [&](const DicomStack& s) {
    const auto& n = image(s).gate_in_words;
    return n ? std::optional<double>(*n) : std::nullopt;
  });
  for (const auto& [name, value] : keys) {
    std::map<double, std::size_t> by_value;
    for (std::size_t n = 0; n < stacks.size(); ++n)
      if (const auto v = value(stacks[n])) by_value.emplace(*v, n);
    if (by_value.size() != stacks.size()) continue;
    DicomStack whole = stacks.front();
    whole.frames.clear();
    whole.gates = static_cast<int>(stacks.size());
    std::vector<double> values;
    for (const auto& [v, n] : by_value) {
      values.push_back(v);
      whole.frames.insert(whole.frames.end(), stacks[n].frames.begin(), stacks[n].frames.end());
    }
    const bool counted = name == "TimeSlotVector" || name == "SeriesDescription";
    const int declared = stacks.front().declared_gates;
    if (counted && (values.back() - values.front() != static_cast<double>(values.size() - 1) ||
                    (name == "TimeSlotVector" && declared > whole.gates)))
      throw InputError(
          image(stacks.front()).path.parent_path().string() + ": the files hold " + std::to_string(stacks.size()) +
          " gates, numbered " + std::to_string(static_cast<int>(values.front())) + " to " +
          std::to_string(static_cast<int>(std::max<double>(values.back(), declared))) + "; a gate is missing");
    whole.declared_gates = whole.gates;
    whole.only_gate.reset();
    if (name == "SeriesDescription")
      note(whole.notes, Severity::warning, "dicom.gate_order",
           "the gates are ordered by the numbers in their series descriptions");
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
