#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "dynasurf/io/detail/output_state.hpp"

namespace dynasurf::io {

namespace staging {
struct Place;

/// The folders that were made above a result; removed again with the object, as far as they are empty, so that failures
/// leave none.
struct MadeFolders {
  std::vector<std::filesystem::path> innermost_first;
  ~MadeFolders();
};
}  // namespace staging

/// Writes a file whole or not at all: beside its place, fsync, rename. Throws IoError (disk full, not writable) and
/// leaves an older file of that name as it was. Inside a folder that an OutputFolder has yet to publish, it writes
/// plainly: publishing makes all files of the folder appear at once, synced. There it throws IoError when the folder is
/// gone, and never makes it anew.
void write_file(const std::filesystem::path& path, std::string_view content);

/// What happens to a file or folder that stands at the destination already.
enum class Existing {
  replace,    ///< a file is replaced; a folder only where it holds nothing but an untouched result of this program
  refuse,     ///< IoError
  move_aside  ///< it is kept beside, as `<name>.old-1`, `.old-2` and so on
};

/// A file that appears whole or not at all, for writers that need a path of their own. Write `path()`; `publish()`
/// syncs it and renames it to the place asked for; without `publish()` the destructor removes what was written.
/// Leftovers of processes that died in mid-write are removed. Throws IoError.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& destination, Existing existing = Existing::replace);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void publish();
  /// Where publish() moved what stood at the destination.
  const std::optional<std::filesystem::path>& moved_to() const { return moved_to_; }

 private:
  void take_the_place();

  std::filesystem::path destination_, path_;
  Existing existing_;
  staging::MadeFolders parents_;
  std::shared_ptr<staging::Place> place_;  // null inside an unpublished folder, where path_ is the destination
  std::optional<std::filesystem::path> moved_to_;
  bool published_ = false;
};

/// A folder that appears whole or not at all. Fill `path()`; `publish()` adds manifest.txt, syncs everything and
/// renames it to the place asked for; without `publish()` the destructor removes what was written. It is filled beside
/// its place, in a folder named `.<name>.partial-<16 hex digits>`; such folders of processes that died are removed.
///
/// A folder at that place is exchanged in one step, so that at no time the result is missing, and only if it is empty
/// or every file in it is, byte for byte, what its manifest lists (Existing::replace). That is looked at when the
/// object is made and again in the act: what appeared meanwhile is put back, and publish() throws IoError.
/// On a file system that cannot exchange folders nothing is replaced.
class OutputFolder {
 public:
  /// Throws IoError for what must not be replaced and for a mount point, OptionError when one of `inputs` is the
  /// destination or lies in it.
  explicit OutputFolder(const std::filesystem::path& destination, Existing existing = Existing::replace,
                        const std::vector<std::filesystem::path>& inputs = {});
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Throws IoError too when a file that was written has vanished or changed its size.
  void publish();
  /// Where publish() moved what stood at the destination.
  const std::optional<std::filesystem::path>& moved_to() const { return moved_to_; }

 private:
  std::filesystem::path destination_, path_;
  Existing existing_;
  staging::MadeFolders parents_;
  std::shared_ptr<staging::Place> place_;
  std::optional<std::filesystem::path> moved_to_;
  bool published_ = false;
};

/// Removes what OutputFile and OutputFolder of this process have not published yet. For the moment before a process
/// ends without unwinding. Waits for a publication in progress; after it nothing can be published any more (Cancelled).
void discard_unpublished() noexcept;

/// That of this process.
OutputState state_of_outputs() noexcept;

}  // namespace dynasurf::io
