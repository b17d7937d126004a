#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dynasurf/core/study.hpp"

namespace dynasurf::io {

/// Photons of lower to upper energy, keV.
struct EnergyRange {
  double lower = 0, upper = 0;
};

/// What one DICOM file says of itself, without its pixels. Absent attributes are absent here too; nothing that
/// identifies a person is kept, but for the UIDs that tell which files belong together and the description of the
/// series, which is compared with what the user asks for and never shown.
struct DicomImage {
  std::filesystem::path path;
  std::string modality;
  std::vector<std::string> image_type;
  std::string sop_class, sop_instance, study, series, series_description;
  std::optional<int> series_number;

  int rows = 0, columns = 0, frames = 1;
  int bits_allocated = 0, bits_stored = 0, high_bit = 0, samples = 1;
  bool is_signed = false;
  double slope = 1, intercept = 0;

  std::optional<std::pair<double, double>> pixel_spacing;  // mm between rows, mm between columns
  std::optional<double> slice_spacing, slice_thickness;    // mm; the spacing is signed
  std::optional<Vec3> position;                            // LPS mm, centre of the first voxel
  std::optional<std::pair<Vec3, Vec3>> orientation;        // unit vectors along columns index (i), rows index (j)
  std::optional<double> slice_location;

  // One entry per frame, counted from 1, and how many there should be.
  std::optional<std::vector<int>> rr_of_frame, gate_of_frame, slice_of_frame;
  std::optional<int> rr_count, gate_count, slice_count;
  std::vector<std::optional<int>> beats_of_rr, rejected_beats_of_rr;
  std::vector<std::optional<double>> frame_time_of_rr, nominal_interval_of_rr;  // ms
  std::vector<std::vector<double>> slot_times_of_rr;                            // ms
  bool counts_back_from_r = false;
  std::optional<std::vector<int>> window_of_frame;  // energy window, one entry per frame, counted from 1
  std::vector<std::vector<EnergyRange>> windows;    // the ranges of each
  std::string isotope;                              // "Tc-99m"; empty when it is not told or not known

  // What tells gates apart when each has files of its own.
  std::optional<double> trigger_time, temporal_position, cycle_percentage, nominal_interval, heart_rate;
  std::optional<int> instance_number, gate_in_words;
  std::optional<int> acquisition, images_in_acquisition;  // its number, and how many images it gave
  std::string series_type;                                // PET: GATED, STATIC, ...; else empty
  bool is_reprojection = false;

  View view = View::unknown;
  bool view_from_words = false;
  SliceOrder slice_order = SliceOrder::unknown;
  Attenuation attenuation = Attenuation::unknown;

  std::string where() const { return path.string(); }
  const std::string& kind() const;  // value 3 of ImageType, "" when absent
};

/// Reads the header of one file. Throws InputError for a file that is cut off, packed in a way that is not read (with
/// the way to convert it), above the limits of an outline, or that contradicts itself; IoError when it cannot be
/// opened.
DicomImage read_dicom_header(const std::filesystem::path& path);

/// Calls `use(frame, values)` for each frame in the order of the file: rows x columns values after rescaling.
/// The pixels are taken from the file frame by frame. Throws InputError when they are fewer or more than the header
/// says, or their run lengths are damaged.
void read_dicom_frames(const DicomImage& image, const std::function<void(int, std::span<const float>)>& use);

/// Isotope, tracer, corrections, beats: words from fixed lists and numbers only.
std::vector<std::pair<std::string, std::string>> acquisition_facts_of(const std::filesystem::path& path);

}  // namespace dynasurf::io
