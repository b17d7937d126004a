#pragma once
#include <filesystem>
#include <span>
#include <string_view>

namespace dynasurf {

/// Writes a file whole or not at all: beside its place, fsync, rename. Throws IoError (disk full, not writable) and
/// leaves an older file of that name as it was. Inside a folder that an OutputFolder has yet to publish, it writes
/// plainly: publishing makes all files of the folder appear at once, synced.
void write_file(const std::filesystem::path& path, std::string_view content);

/// A file that appears whole or not at all, for writers that need a path of their own. Write `path()`; `publish()`
/// syncs it and renames it to the place asked for; without `publish()` the destructor removes what was written.
/// Leftovers of processes that died in mid-write are removed. Throws IoError.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& destination);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::filesystem::path& path() const { return staging_; }
  void publish();

 private:
  std::filesystem::path destination_, staging_;
  bool published_ = false;
};

/// A folder that appears whole or not at all. Fill `path()`; `publish()` syncs everything and renames it to the place
/// asked for; without `publish()` the destructor removes what was written. It is filled beside its place, in a folder
/// named `.<name>.partial-<process>`; such folders of processes that died are removed.
/// An existing folder at that place is replaced in the same way (exchanged where the file system can, so that at no
/// time the result is missing), and only if it holds a former result (a results.json), is empty, or `overwrite_any`
/// is set; else the constructor throws IoError.
class OutputFolder {
 public:
  explicit OutputFolder(const std::filesystem::path& destination, bool overwrite_any = false);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return staging_; }
  void publish();

 private:
  std::filesystem::path destination_, staging_;
  bool published_ = false;
};

}  // namespace dynasurf
