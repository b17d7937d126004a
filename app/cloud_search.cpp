#include "cloud_search.hpp"

#include <algorithm>

#include "dynasurf/core/error.hpp"

#include "cloud_names.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 1'000'000;

std::vector<fs::path> files_below(const fs::path& folder, const Progress& progress) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, error);
  for (const fs::recursive_directory_iterator end; !error && entry != end; entry.increment(error)) {
    progress.check();
    std::error_code unreadable;
    if (entry->is_regular_file(unreadable)) files.push_back(entry->path());
    if (files.size() > most_files)
      throw InputError(folder.string() + ": holds more than a million files; expected fewer, or a table of clouds");
  }
  if (error) throw IoError(folder.string() + ": cannot be listed: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

io::StudySearch search_clouds(const fs::path& folder, const Progress& progress) {
  io::StudySearch found;
  for (const fs::path& file : files_below(folder, progress)) {
    if (is_cloud(file))
      found.studies.push_back({{file}, "", 0});
    else if (ends_as_one_of(file, {".txt", ".csv"}))
      found.left_out.push_back({file, "may be any text; a table of clouds names those that are points"});
    else
      found.left_out.push_back({file, "its name has no ending of a point cloud"});
  }
  return found;
}

}  // namespace dynasurf::app
