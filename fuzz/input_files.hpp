#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace dynasurf::fuzz {

/// Files of one run of a target, for readers that open their files by name. They go away with the object; there is one
/// object at a time. Under libFuzzer they are never on a disk: memory_files.cpp stands between the readers and the
/// system's open and read. The replay, which links any build of the readers, writes them: disk_files.cpp.
class InputFiles {
 public:
  InputFiles();
  ~InputFiles();
  InputFiles(const InputFiles&) = delete;
  InputFiles& operator=(const InputFiles&) = delete;

  /// Adds a file and gives its path. `bytes` must outlive this object.
  std::filesystem::path add(const std::string& name, std::string_view bytes);
  /// The folder they are in, without a slash at its end.
  const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
};

}  // namespace dynasurf::fuzz
