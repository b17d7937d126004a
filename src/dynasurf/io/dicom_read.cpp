#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <tuple>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/dicom_choice.hpp"
#include "dynasurf/io/detail/dicom_file.hpp"
#include "dynasurf/io/detail/dicom_group.hpp"
#include "dynasurf/io/detail/dicom_look.hpp"
#include "dynasurf/io/detail/dicom_stacking.hpp"
#include "dynasurf/io/detail/digest.hpp"
#include "dynasurf/io/detail/formats.hpp"
#include "dynasurf/io/detail/samples.hpp"
#include "dynasurf/io/detail/study_mend.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;

/// What will be read: the headers of the files in play and where their frames go.
struct Plan {
  std::vector<DicomImage> images;
  DicomStack stack;
  std::string series;  // what --series calls it, when the user chose
};

// Files below a folder that are looked at: a study of one file per slice and gate has some hundred.
constexpr std::size_t most_files = 100'000;

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it.depth() >= 8) it.disable_recursion_pending();
    if (it->is_regular_file(error)) files.push_back(it->path());
    if (files.size() > most_files)
      throw InputError(folder.string() + ": holds more than " + std::to_string(most_files) +
                       " files; give the folder of one study");
  }
  if (error) throw IoError(folder.string() + ": cannot list this folder: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

void choose(Plan& plan, std::vector<DicomStack> stacks, const std::string& series, const fs::path& where) {
  DicomChoice choice = chosen_stack(plan.images, std::move(stacks), series, where.string());
  plan.stack = std::move(choice.stack);
  plan.series = std::move(choice.series);
}

Plan plan_of_folder(const fs::path& folder, const std::string& series) {
  Plan plan;
  std::size_t others = 0, unusable = 0;
  std::string first_reason;
  for (const fs::path& file : files_below(folder)) {
    const DicomLook look = dicom_look_of(first_bytes(file, 132));
    if (look == DicomLook::none) {
      ++others;
      continue;
    }
    try {
      DicomImage image = read_dicom_header(file);
      std::string reason = reason_to_refuse(image);
      if (reason.empty()) {
        plan.images.push_back(std::move(image));
      } else {
        ++unusable;
        if (first_reason.empty()) first_reason = file.string() + ": " + reason;
      }
    } catch (const InputError& error) {
      // Bytes that only happen to look like bare DICOM are no study; but a damaged DICOM file may be a slice of it.
      const bool no_image = std::string(error.what()).find(": holds no pixel data") != std::string::npos;
      if (look == DicomLook::preamble && !no_image) throw;
      ++others;
    }
  }
  if (plan.images.empty() && !first_reason.empty()) throw InputError(first_reason);
  if (plan.images.empty())
    throw InputError(folder.string() + ": holds no DICOM image; expected the files of one heart study");
  const std::size_t copies = drop_copies(plan.images);
  choose(plan, with_joined_gates(plan.images, stacks_of(plan.images)), series, folder);
  if (copies > 0)
    plan.stack.notes.push_back({Severity::info, "dicom.copies",
                                std::to_string(copies) + " files of the folder are copies of others and left out"});
  if (others + unusable > 0)
    plan.stack.notes.push_back({Severity::info, "dicom.skipped_files",
                                std::to_string(others + unusable) + " files of the folder are not part of the study (" +
                                    std::to_string(others) + " are not DICOM images, " + std::to_string(unusable) +
                                    " are images of another kind)"});
  return plan;
}

Plan plan_of(const fs::path& path, const std::string& series) {
  std::error_code error;
  if (fs::is_directory(path, error)) return plan_of_folder(path, series);
  Plan plan;
  plan.images.push_back(read_dicom_header(path));
  const DicomImage& image = plan.images.front();
  if (const std::string reason = reason_to_refuse(image); !reason.empty())
    throw InputError(path.string() + ": " + reason);
  const std::size_t only[] = {0};
  choose(plan, {image.modality == "NM" ? stack_of_frames(image, 0) : stack_of_slices(plan.images, only)}, series, path);
  return plan;
}

/// A stack that is one gate of several is not a study.
void check_whole(const Plan& plan) {
  if (plan.stack.declared_gates <= plan.stack.gates) return;
  throw InputError(plan.images[plan.stack.first_file()].where() + ": holds gate " +
                   std::to_string(plan.stack.only_gate.value_or(1)) + " of " +
                   std::to_string(plan.stack.declared_gates) + " only; give the folder with the files of all gates");
}

std::vector<Image> read_pixels(const Plan& plan, Notes& notes) {
  const DicomStack& stack = plan.stack;
  require_memory_of_study(stack.grid, stack.gates, plan.images[stack.first_file()].where());
  const std::size_t slices = stack.grid.dims[2];
  const std::size_t pixels = stack.grid.size() / slices;
  std::map<std::size_t, std::map<int, std::size_t>> place_of;  // file -> frame -> place in the stack
  for (std::size_t p = 0; p < stack.frames.size(); ++p) place_of[stack.frames[p].file][stack.frames[p].frame] = p;

  std::vector<Image> gates(stack.gates);
  for (const auto& [file, frames] : place_of)
    read_dicom_frames(plan.images[file], [&, &here = frames](int frame, std::span<const float> values) {
      const auto it = here.find(frame);
      if (it == here.end()) return;
      Image& gate = gates[it->second / slices];
      // Memory is taken as the pixels arrive, not for what the headers promise.
      if (gate.values.empty()) gate = Image(stack.grid);
      std::copy(values.begin(), values.end(), gate.values.begin() + it->second % slices * pixels);
    });
  fill_outside_field(gates, plan.images[stack.first_file()].where(), notes);
  return gates;
}

/// Words of ImageType and SeriesType that are passed on: defined terms only, never free text.
std::string image_type_of(const DicomImage& image) {
  if (image.modality == "NM") return image.kind();
  for (const char* word : {"GATED", "STATIC", "DYNAMIC", "WHOLE BODY"})
    if (image.series_type == word) return word;
  return "";
}

}  // namespace

Study read_dicom(const std::filesystem::path& path, const std::string& series) {
  Plan plan = plan_of(path, series);
  check_whole(plan);
  const DicomImage& first = plan.images[plan.stack.first_file()];
  Study study;
  study.gates = read_pixels(plan, plan.stack.notes);
  study.format = "DICOM";
  study.modality = first.modality;
  study.image_type = image_type_of(first);
  study.time_ms = plan.stack.time_ms;
  study.cycle_ms = plan.stack.cycle_ms;
  study.view = first.view;
  study.slice_order = first.slice_order;
  study.attenuation = first.attenuation;
  study.series = plan.series;
  study.notes = plan.stack.notes;
  if (first.view_from_words)
    study.notes.push_back({Severity::info, "dicom.view_in_words",
                           "that the slices are " + std::string(name_of(first.view)) +
                               " is taken from the description, not from a code"});
  return study;
}

std::vector<std::filesystem::path> files_of_dicom(const std::filesystem::path& path, const std::string& series) {
  const Plan plan = plan_of(path, series);
  std::vector<fs::path> files;
  for (const DicomStack::Frame& frame : plan.stack.frames) files.push_back(plan.images[frame.file].path);
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

std::vector<std::pair<std::string, std::string>> dicom_facts(const std::filesystem::path& path,
                                                             const std::string& series) {
  return acquisition_facts_of(files_of_dicom(path, series).front());
}

}  // namespace dynasurf::io
