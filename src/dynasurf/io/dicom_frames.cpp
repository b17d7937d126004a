#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_places.hpp"
#include "dynasurf/io/detail/dicom_stacking.hpp"
#include "dynasurf/io/detail/dicom_words.hpp"
#include "dynasurf/io/detail/samples.hpp"

namespace dynasurf::io {
namespace {

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
    const std::size_t at = window - first;
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
      const auto at = counts.find((*image.window_of_frame)[frame]);
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
  count = windows.size();
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

std::string pair_text(int gate, int slice) {
  return "gate " + std::to_string(gate + 1) + ", slice " + std::to_string(slice + 1);
}

/// How the frames of a file count, and where each belongs: entries from 1, one a frame.
struct FrameLayout {
  int rr_count = 1, gates = 1, slices = 1;
  std::vector<int> rr, gate, slice;
  std::optional<int> window;  // the only one to be read, where there are several
};

/// How many gates and slices there are: as declared, else as far as the vectors count, else what the frames leave.
void count_frames(FrameLayout& layout, const DicomImage& image, const FrameVectors& vectors, bool gated, Notes& notes) {
  layout.gates = gated ? image.gate_count.value_or(vectors.gate ? largest(*vectors.gate) : 0) : 1;
  layout.slices = image.slice_count.value_or(vectors.slice ? largest(*vectors.slice) : 0);
  int windows = 1;
  layout.window = chosen_window(image, notes, windows);
  const int per_rr = image.frames / std::max(layout.rr_count, 1) / windows;
  if (layout.slices == 0) layout.slices = layout.gates > 0 ? per_rr / layout.gates : 0;
  if (layout.gates == 0) layout.gates = layout.slices > 0 ? per_rr / layout.slices : 0;
  if (layout.slices < 1 || layout.gates < 1)
    throw InputError(image.where() + ": says neither how many gates nor how many slices its " +
                     std::to_string(image.frames) + " frames are");
}

/// Without a vector the frames count slices first, then gates.
void assume_order(FrameLayout& layout, const DicomImage& image, Notes& notes) {
  if (static_cast<long long>(layout.gates) * layout.slices != image.frames || layout.rr_count != 1 || layout.window)
    throw InputError(image.where() + ": has no SliceVector or TimeSlotVector, and " + std::to_string(image.frames) +
                     " frames are not " + std::to_string(layout.gates) + " gates of " + std::to_string(layout.slices) +
                     " slices");
  note(notes, Severity::info, "dicom.no_frame_vectors",
       "the order of the frames is assumed: all slices of a gate, then the next gate");
  for (std::size_t f = 0; f < layout.gate.size(); ++f) {
    layout.gate[f] = static_cast<int>(f) / layout.slices + 1;
    layout.slice[f] = static_cast<int>(f) % layout.slices + 1;
  }
}

FrameLayout layout_of(const DicomImage& image, Notes& notes) {
  FrameLayout layout;
  layout.gate.assign(image.frames, 1);
  layout.rr = layout.slice = layout.gate;
  const FrameVectors vectors = vectors_of(image, notes);
  layout.rr_count = image.rr_count.value_or(vectors.rr ? largest(*vectors.rr) : 1);
  if (vectors.rr)
    check_entries(layout.rr = *vectors.rr, image, layout.rr_count, "RRIntervalVector");
  else if (layout.rr_count != 1)
    throw InputError(image.where() + ": has " + std::to_string(layout.rr_count) +
                     " R-R intervals but no RRIntervalVector");

  const bool gated = image.kind() == "RECON GATED TOMO" || vectors.gate;
  count_frames(layout, image, vectors, gated, notes);
  if (!vectors.slice || (gated && !vectors.gate)) assume_order(layout, image, notes);
  if (vectors.slice) check_entries(layout.slice = *vectors.slice, image, layout.slices, "SliceVector");
  if (vectors.gate)
    check_entries(layout.gate = *vectors.gate, image, std::max(layout.gates, largest(*vectors.gate)), "TimeSlotVector");
  return layout;
}

/// A file that holds one gate of several numbers its frames by that gate.
void recognise_one_gate(FrameLayout& layout, const DicomImage& image, DicomStack& stack) {
  const bool is_one_gate = image.gate_of_frame && std::set<int>(layout.gate.begin(), layout.gate.end()).size() == 1;
  if (is_one_gate && (image.gate_of_frame->front() != 1 || layout.gates > 1)) {
    stack.only_gate = image.gate_of_frame->front();
    stack.declared_gates = std::max(layout.gates, layout.gate[0]);
    layout.gates = 1;
    std::fill(layout.gate.begin(), layout.gate.end(), 1);
  }
  if (largest(layout.gate) > layout.gates)
    throw InputError(image.where() + ": TimeSlotVector counts to " + std::to_string(largest(layout.gate)) +
                     ", NumberOfTimeSlots says " + std::to_string(layout.gates));
}

/// The frame of each place, gate after gate, slice after slice, among those of R-R interval `rr`.
std::vector<int> frames_by_place(const FrameLayout& layout, const DicomImage& image, int rr) {
  const std::size_t places = layout.gates * static_cast<std::size_t>(layout.slices);
  if (places > layout.rr.size())
    throw InputError(image.where() + ": " + std::to_string(image.frames) + " frames cannot be " +
                     std::to_string(layout.gates) + " gates of " + std::to_string(layout.slices) +
                     " slices: some (gate, slice) pair is missing");
  std::vector<int> frame_at(places, -1);
  for (int f = 0; f < image.frames; ++f) {
    if (layout.rr[f] != rr || (layout.window && (*image.window_of_frame)[f] != *layout.window)) continue;
    const int gate = layout.gate[f] - 1, slice = layout.slice[f] - 1;
    int& at = frame_at[gate * static_cast<std::size_t>(layout.slices) + slice];
    if (at >= 0)
      throw InputError(image.where() + ": frames " + std::to_string(at + 1) + " and " + std::to_string(f + 1) +
                       " are both " + pair_text(gate, slice));
    at = f;
  }
  for (std::size_t p = 0; p < places; ++p)
    if (frame_at[p] < 0)
      throw InputError(image.where() + ": no frame is " +
                       pair_text(static_cast<int>(p) / layout.slices, static_cast<int>(p) % layout.slices));
  return frame_at;
}

}  // namespace

DicomStack stack_of_frames(const DicomImage& image, std::size_t file) {
  DicomStack stack;
  FrameLayout layout = layout_of(image, stack.notes);
  recognise_one_gate(layout, image, stack);
  check_study_size(image.columns, image.rows, layout.slices, layout.gates, image.where());
  const int rr = chosen_rr(image, layout.rr_count, stack.notes);
  for (const int frame : frames_by_place(layout, image, rr)) stack.frames.push_back({file, frame});

  stack.gates = layout.gates;
  const Placement place = placement_of(image, stack.notes);
  const double spacing = slice_spacing_of(image, stack.notes, layout.slices > 1);
  Mat3 steps;
  // The sign of the spacing is kept: the grid is left-handed then.
  steps << place.right * place.column_mm, place.down * place.row_mm, place.normal * spacing;
  stack.grid = grid_from_steps({image.columns, image.rows, layout.slices}, steps, place.origin, image.where());
  set_gate_times(stack, image, rr);
  return stack;
}

}  // namespace dynasurf::io
