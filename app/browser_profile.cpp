#include "browser_profile.hpp"

#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"

#include "removed_at_end.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view profile_prefix = "dynasurf-print-";

/// A locked folder says that its run is alive: the system unlocks it when the run ends, however it ends.
class Lock {
 public:
  explicit Lock(const fs::path& folder)
      : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)) {
    struct stat locked {};
    struct stat there {};
    held_ = descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 && ::fstat(descriptor_, &locked) == 0 &&
            ::lstat(folder.c_str(), &there) == 0 && locked.st_ino == there.st_ino && locked.st_dev == there.st_dev;
    is_ours_ = held_ && locked.st_uid == ::geteuid() && (locked.st_mode & 0777) == 0700;
  }
  ~Lock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  bool is_held() const { return held_; }
  bool is_ours() const { return is_ours_; }

 private:
  int descriptor_;
  bool held_ = false, is_ours_ = false;
};

/// Removes the profiles of runs that were killed: folders, never links, of this user, that no run holds.
void sweep_profiles(const fs::path& place) {
  std::error_code ignored;
  for (fs::directory_iterator it(place, ignored), end; !ignored && it != end; it.increment(ignored)) {
    const fs::path folder = it->path();
    if (!folder.filename().native().starts_with(profile_prefix)) continue;
    const Lock lock(folder);
    std::error_code unremoved;
    if (lock.is_ours()) fs::remove_all(folder, unremoved);
  }
}

fs::path temporary_place() {
  std::error_code error;
  fs::path place = fs::temp_directory_path(error);
  if (error) throw IoError("printing needs a folder for temporary files, and TMPDIR names none");
  return place;
}

}  // namespace

struct BrowserProfile::Held {
  std::optional<Lock> lock;
  std::optional<RemovedAtEnd> folder;  // goes first, while it is locked
};

BrowserProfile::BrowserProfile() : held_(std::make_unique<Held>()) {
  const fs::path place = temporary_place();
  sweep_profiles(place);
  // Another run may sweep a new folder in the moment before it is locked; then there is the next one.
  constexpr int attempts = 10;
  for (int attempt = 0; attempt < attempts && !(held_->lock && held_->lock->is_held()); ++attempt) {
    held_->lock.reset();
    std::string name = (place / profile_prefix).string() + "XXXXXX";
    if (!::mkdtemp(name.data()))
      throw IoError("cannot make a folder in " + place.string() + ": " + std::strerror(errno));
    held_->folder.emplace(name);
    held_->lock.emplace(name);
  }
}

BrowserProfile::~BrowserProfile() = default;

const fs::path& BrowserProfile::path() const { return held_->folder->path(); }

}  // namespace dynasurf::app
