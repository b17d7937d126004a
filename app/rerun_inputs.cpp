#include <algorithm>
#include <map>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/study_io.hpp"

#include "reconstruction.hpp"
#include "rerun_parts.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

/// No reader takes a larger file: what is larger need not be hashed.
constexpr std::uintmax_t largest_input = std::uintmax_t{4} << 30;

bool may_be_input(const fs::path& file, const RerunRecord& record) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error || bytes > largest_input) return false;
  return record.bytes.empty() || std::find(record.bytes.begin(), record.bytes.end(), bytes) != record.bytes.end();
}

bool is_study(const fs::path& path, const RerunRecord& record) {
  try {
    const std::vector<fs::path> files = io::files_of_study(path, record.series);
    return files.size() == record.hashes.size() &&
           std::all_of(files.begin(), files.end(), [&](const fs::path& file) { return may_be_input(file, record); }) &&
           hashes_of_study(path, record.series) == record.hashes;
  } catch (const std::exception&) {
    return false;  // not a study at all
  }
}

/// What lies beside the result and in the working folder, where the files of a run are looked for.
std::vector<fs::path> places_beside(const RerunArguments& arguments) {
  const fs::path result = fs::weakly_canonical(arguments.result);
  std::vector<fs::path> all;
  for (const fs::path& place : {result.parent_path(), fs::current_path()}) {
    std::vector<fs::path> candidates;
    for (const auto& entry : fs::directory_iterator(place, fs::directory_options::skip_permission_denied))
      if (entry.path() != result && !fs::exists(entry.path() / "results.json") &&
          (entry.is_regular_file() || entry.is_directory()))
        candidates.push_back(entry.path());
    std::sort(candidates.begin(), candidates.end());
    all.insert(all.end(), candidates.begin(), candidates.end());
  }
  return all;
}

[[noreturn]] void throw_missing(const RerunArguments& arguments, const std::string& hash, const std::string& name) {
  throw InputError(arguments.result + ": its input (SHA-256 " + hash.substr(0, 12) +
                   "...) is neither beside it nor in the working folder; name it with " + name);
}

}  // namespace

fs::path find_study(const RerunArguments& arguments, const RerunRecord& record) {
  if (arguments.inputs.size() > 1) throw OptionError("--input names more than one study");
  if (!arguments.inputs.empty()) {
    const std::string& study = arguments.inputs[0];
    if (hashes_of_study(study, record.series) != record.hashes)
      throw InputError(study + ": is not the study the result was made from (SHA-256 " +
                       record.hashes.front().substr(0, 12) + "... expected)");
    return study;
  }
  for (const fs::path& candidate : places_beside(arguments))
    if ((record.hashes.size() > 1 || !record.series.empty() || fs::is_regular_file(candidate)) &&
        is_study(candidate, record))
      return candidate;
  throw_missing(arguments, record.hashes.front(), "--study");
}

std::vector<fs::path> find_clouds(const RerunArguments& arguments, const RerunRecord& record) {
  std::vector<fs::path> candidates(arguments.inputs.begin(), arguments.inputs.end());
  if (candidates.empty())
    for (const fs::path& path : places_beside(arguments))
      if (fs::is_regular_file(path) && may_be_input(path, record)) candidates.push_back(path);
  std::map<std::string, fs::path> by_hash;
  for (const fs::path& path : candidates) try {
      by_hash.emplace(io::sha256_of_file(path), path);
    } catch (const IoError&) {
      if (!arguments.inputs.empty()) throw;  // what the user names must be readable
    }
  std::vector<fs::path> found;
  for (const std::string& hash : record.hashes) {
    const auto at = by_hash.find(hash);
    if (at == by_hash.end()) throw_missing(arguments, hash, "--input");
    found.push_back(at->second);
  }
  return found;
}

fs::path find_given(const RerunArguments& arguments, const std::string& hash, const std::string& named,
                    const std::string& what) {
  if (hash.empty()) return {};
  if (!named.empty()) {
    if (io::sha256_of_file(named) != hash)
      throw InputError(named + ": is not the " + what + " the result was made with (SHA-256 " + hash.substr(0, 12) +
                       "... expected)");
    return named;
  }
  for (const fs::path& candidate : places_beside(arguments))
    if (std::error_code error; fs::is_regular_file(candidate, error) &&
                               fs::file_size(candidate, error) <= largest_input &&
                               io::sha256_of_file(candidate) == hash)
      return candidate;
  throw InputError(arguments.result + ": its " + what + " (SHA-256 " + hash.substr(0, 12) +
                   "...) is neither beside it nor in the working folder; name it with --" + what);
}

}  // namespace dynasurf::app
