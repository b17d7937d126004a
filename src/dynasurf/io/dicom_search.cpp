#include "dynasurf/io/detail/dicom_search.hpp"

#include <map>
#include <set>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/dicom_choice.hpp"
#include "dynasurf/io/detail/dicom_file.hpp"
#include "dynasurf/io/detail/dicom_group.hpp"
#include "dynasurf/io/detail/dicom_look.hpp"
#include "dynasurf/io/detail/dicom_stacking.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;
using Images = std::vector<DicomImage>;

constexpr const char* no_format = "no DICOM, NIfTI or NRRD file";

/// Why a message of a reader says that a file is refused, without the name of the file in front.
std::string without_name(const std::string& message, const fs::path& file) {
  const std::string name = file.string() + ": ";
  return message.starts_with(name) ? message.substr(name.size()) : message;
}

/// Files of one examination, by its UID; those without one belong together by their folder.
void sort_in(const fs::path& file, std::map<std::string, Images>& examinations, StudySearch& found) {
  const DicomLook look = dicom_look_of(first_bytes(file, 132));
  const auto leave_out = [&](const std::string& reason) { found.left_out.push_back({file, reason}); };
  if (look == DicomLook::none) return leave_out(no_format);
  try {
    DicomImage image = read_dicom_header(file);
    if (const std::string reason = reason_to_refuse(image); !reason.empty()) {
      leave_out(without_name(reason, file));
      return;
    }
    const std::string key = image.study.empty() ? "in " + file.parent_path().string() : image.study;
    examinations[key].push_back(std::move(image));
  } catch (const InputError& error) {
    const std::string reason = without_name(error.what(), file);
    if (reason.starts_with("holds no pixel data"))
      leave_out("no image");
    else if (look == DicomLook::preamble)
      found.studies.push_back({{file}, ""});
    else
      leave_out(no_format);
  }
}

std::vector<fs::path> files_of(const Images& images, const DicomStack& stack) {
  std::set<fs::path> files;
  for (const DicomStack::Frame& frame : stack.frames) files.insert(images[frame.file].path);
  return {files.begin(), files.end()};
}

/// Where several gated stacks of an examination differ in their energy window alone, that of the photopeak is the
/// study.
std::vector<DicomStack> without_other_windows(const Images& images, std::vector<DicomStack> stacks) {
  if (stacks.size() < 2) return stacks;
  try {
    return {chosen_stack(images, stacks, "", "").stack};
  } catch (const InputError&) {
    return stacks;
  }
}

void take_stacks(const Images& images, std::vector<DicomStack> stacks, StudySearch& found) {
  std::vector<DicomStack> wanted;
  for (DicomStack& stack : stacks) {
    const DicomImage& image = images[stack.first_file()];
    if (is_wanted(image, stack)) {
      wanted.push_back(std::move(stack));
      continue;
    }
    for (const fs::path& file : files_of(images, stack))
      found.left_out.push_back({file, "not gated short-axis: " + description_of(image, stack)});
  }
  std::set<fs::path> taken;
  const std::vector<DicomStack> kept = without_other_windows(images, wanted);
  for (const DicomStack& stack : kept) {
    found.studies.push_back({files_of(images, stack), description_of(images[stack.first_file()], stack)});
    taken.insert(found.studies.back().files.begin(), found.studies.back().files.end());
  }
  for (const DicomStack& stack : wanted)
    for (const fs::path& file : files_of(images, stack))
      if (!taken.contains(file)) found.left_out.push_back({file, "another energy window than the photopeak's"});
}

void drop_and_tell_copies(Images& images, StudySearch& found) {
  std::set<fs::path> before;
  for (const DicomImage& image : images) before.insert(image.path);
  if (drop_copies(images) == 0) return;
  for (const DicomImage& image : images) before.erase(image.path);
  for (const fs::path& copy : before) found.left_out.push_back({copy, "a copy of another file"});
}

/// Stacks that cannot be made are told by reading the series, which says what is wrong.
void look_at_series(const Images& images, StudySearch& found) {
  std::map<std::string, Images> series;
  for (const DicomImage& image : images) series[image.series].push_back(image);
  for (auto& [uid, part] : series) try {
      take_stacks(part, with_joined_gates(part, stacks_of(part)), found);
    } catch (const InputError&) {
      StudySearch::Found damaged;
      for (const DicomImage& image : part) damaged.files.push_back(image.path);
      found.studies.push_back(std::move(damaged));
    }
}

void look_at_examination(Images images, StudySearch& found) {
  drop_and_tell_copies(images, found);
  std::vector<DicomStack> stacks;
  try {
    stacks = with_joined_gates(images, stacks_of(images));
  } catch (const InputError&) {
    look_at_series(images, found);
    return;
  }
  take_stacks(images, std::move(stacks), found);
}

}  // namespace

void search_dicom(const std::vector<fs::path>& files, StudySearch& found, const Progress& progress) {
  std::map<std::string, Images> examinations;
  for (std::size_t n = 0; n < files.size(); ++n) {
    progress.check();
    if (n % 1000 == 0) progress("search DICOM", n, files.size());
    sort_in(files[n], examinations, found);
  }
  int examination = 0;
  for (auto& [uid, images] : examinations) {
    progress.check();
    const std::size_t before = found.studies.size();
    look_at_examination(std::move(images), found);
    ++examination;
    for (std::size_t n = before; n < found.studies.size(); ++n) found.studies[n].examination = examination;
  }
}

}  // namespace dynasurf::io
