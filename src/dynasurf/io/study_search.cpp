#include <algorithm>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_choice.hpp"
#include "dynasurf/io/detail/dicom_search.hpp"
#include "dynasurf/io/detail/formats.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 1'000'000;

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    // A file may vanish between the listing and the look at it: it is passed over then.
    std::error_code vanished;
    if (it->is_regular_file(vanished)) files.push_back(it->path());
    if (files.size() > most_files)
      throw InputError(folder.string() + ": holds more than " + std::to_string(most_files) +
                       " files; give a part of it, or a table of studies");
  }
  if (error) throw IoError(folder.string() + ": cannot list this folder: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

bool has_ending(const fs::path& file, std::initializer_list<std::string_view> endings) {
  const std::string name = file.filename().string();
  return std::any_of(endings.begin(), endings.end(), [&](std::string_view ending) { return name.ends_with(ending); });
}

bool is_nifti(const fs::path& file) { return has_ending(file, {".nii", ".nii.gz"}); }
bool is_nrrd(const fs::path& file) { return has_ending(file, {".nrrd", ".nhdr"}); }

void look_at_volume(const fs::path& file, StudySearch& found) {
  std::string what;
  try {
    const Study study = is_nifti(file) ? read_nifti(file) : read_nrrd(file);
    if (study.gates.size() < 2) {
      found.left_out.push_back({file, "not gated"});
      return;
    }
    what = size_in_words(study.gates.size(), study.grid().dims);
  } catch (const InputError&) {  // reading it as a study tells why
  }
  found.studies.push_back({{file}, what});
}

}  // namespace

StudySearch search_studies(const std::filesystem::path& folder, const Progress& progress) {
  StudySearch found;
  std::vector<fs::path> dicom;
  const std::vector<fs::path> files = files_below(folder);
  for (std::size_t n = 0; n < files.size(); ++n) {
    progress.check();
    if (n % 1000 == 0) progress("search", n, files.size());
    // DICOM has no ending of its own: whatever is nothing else may be it.
    if (is_nifti(files[n]) || is_nrrd(files[n]))
      look_at_volume(files[n], found);
    else
      dicom.push_back(files[n]);
  }
  search_dicom(dicom, found, progress);
  std::sort(found.studies.begin(), found.studies.end(), [](const auto& a, const auto& b) { return a.files < b.files; });
  std::sort(found.left_out.begin(), found.left_out.end(), [](const auto& a, const auto& b) { return a.file < b.file; });
  return found;
}

}  // namespace dynasurf::io
