#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

#include "dynasurf/io/detail/staging.hpp"

namespace dynasurf::cohort {

/// Which studies somebody works on at this moment, over all processes and machines that share a folder. A claim is a
/// lock on one byte of one file, at the place that the hash of its name says: the system drops it when the process
/// ends, however it ends, and no file is left behind for a claim. Two names that fall on one byte keep each other
/// waiting and lose nothing else. File systems without locks are refused with IoError; shards need them too, since a
/// restarted task may meet its predecessor.
class Claims {
 public:
  /// Makes the file where there is none.
  explicit Claims(const std::filesystem::path& file);

  /// False when another process holds it. A claim of this object may be taken again.
  bool take(std::string_view name);
  void release(std::string_view name);

 private:
  std::filesystem::path path_;
  io::staging::Descriptor file_;
};

/// Holds a lock on a whole open file until its end; waits for it. Throws IoError.
class FileLock {
 public:
  FileLock(int descriptor, const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace dynasurf::cohort
