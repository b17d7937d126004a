#include "dynasurf/cohort/detail/job_key.hpp"

#include <algorithm>

#include <sys/stat.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/digest.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::cohort {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 100'000;

/// The file itself, or the files below a folder, sorted.
std::vector<fs::path> files_of_input(const fs::path& study) {
  std::error_code error;
  if (!fs::is_directory(study, error)) return {study};
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator it(study, error), end; !error && it != end; it.increment(error)) {
    std::error_code vanished;
    if (it->is_regular_file(vanished)) files.push_back(it->path());
    if (files.size() > most_files)
      throw IoError(study.string() + ": holds more than " + std::to_string(most_files) +
                    " files; expected the folder of one study");
  }
  if (error) throw IoError(study.string() + ": cannot list this folder: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

/// With its length before it: "ab", "c" and "a", "bc" are not the same.
void add(io::Hasher& hasher, std::string_view text) {
  const std::string size = std::to_string(text.size()) + ":";
  hasher.add(size.data(), size.size());
  hasher.add(text.data(), text.size());
}

/// The word, or what follows its "=", where that names a file.
fs::path file_in(const std::string& word) {
  std::error_code error;
  const std::size_t sign = word.find('=');
  for (const std::string& name : {word, sign == std::string::npos ? std::string() : word.substr(sign + 1)})
    if (!name.empty() && fs::is_regular_file(name, error)) return name;
  return {};
}

}  // namespace

std::string input_hash(const std::filesystem::path& study) {
  std::error_code error;
  if (!fs::is_directory(study, error)) return io::sha256_of_file(study);
  io::Hasher hasher;
  for (const fs::path& file : files_of_input(study)) {
    add(hasher, file.lexically_relative(study).string());
    add(hasher, io::sha256_of_file(file));
  }
  return io::hexadecimal(hasher.finish());
}

std::string input_stamp(const std::filesystem::path& study) {
  io::Hasher hasher;
  for (const fs::path& file : files_of_input(study)) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) return {};
    add(hasher, file.lexically_relative(study).string());
    add(hasher, std::to_string(status.st_size));
    add(hasher, std::to_string(status.st_mtim.tv_sec));
    add(hasher, std::to_string(status.st_mtim.tv_nsec));
  }
  return io::hexadecimal(hasher.finish()).substr(0, 16);
}

std::string settings_hash(const std::vector<std::string>& words, std::string_view program) {
  io::Hasher hasher;
  add(hasher, program);
  for (const std::string& word : words) {
    add(hasher, word);
    if (const fs::path file = file_in(word); !file.empty()) add(hasher, io::sha256_of_file(file));
  }
  return io::hexadecimal(hasher.finish()).substr(0, 16);
}

std::filesystem::path result_folder(const std::filesystem::path& cohort, const std::string& id) {
  return cohort / "studies" / io::sha256_of(id).substr(0, 2) / id;
}

}  // namespace dynasurf::cohort
