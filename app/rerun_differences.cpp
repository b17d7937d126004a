#include <fstream>
#include <iterator>
#include <set>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/detail/manifest.hpp"

#include "rerun_parts.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw IoError(path.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What a result holds: what its manifest lists, but for what has gone. Everything where there is no manifest.
std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> files;
  if (fs::exists(folder / io::manifest_name)) {
    for (const io::ManifestEntry& file : io::read_manifest(folder))
      if (fs::exists(folder / file.name)) files.insert(file.name);
    return files;
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.insert(entry.path().lexically_relative(folder).string());
  return files;
}

/// Times and memory are what a repeated run may tell otherwise. The printed pages are Chromium's, not ours: another
/// version may set them otherwise.
bool same(const fs::path& a, const fs::path& b, const std::string& file) {
  if (file == "report.pdf" || file == "dicom/report.dcm") return true;
  const std::string old_bytes = bytes_of(a);
  const std::string new_bytes = bytes_of(b);
  if (old_bytes == new_bytes) return true;
  if (file != "results.json") return false;
  Json old_json = io::parse_json(old_bytes, a.string());
  Json new_json = io::parse_json(new_bytes, b.string());
  for (const char* key : {"timings_s", "memory"}) {
    old_json.erase(key);
    new_json.erase(key);
  }
  return old_json == new_json;
}

}  // namespace

std::string alteration_of(const fs::path& result) {
  if (!fs::exists(result / io::manifest_name)) return {};
  const auto foreign = io::first_foreign_file(result);
  return foreign ? foreign->name + " in it " + foreign->why + "\n" : std::string();
}

std::vector<std::string> differences(const fs::path& before, const fs::path& after, const std::stop_token& stop,
                                     std::size_t& compared) {
  std::set<std::string> files = files_in(before);
  files.merge(files_in(after));
  files.erase("live.html");  // holds the study and the other files, by whatever page there is
  compared = files.size();
  std::vector<std::string> different;
  for (const std::string& file : files) {
    if (stop.stop_requested()) throw Cancelled("stopped on request");
    if (!fs::exists(before / file) || !fs::exists(after / file) || !same(before / file, after / file, file))
      different.push_back(file);
  }
  return different;
}

}  // namespace dynasurf::app
