#include "print_page.hpp"

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"

#include "child_process.hpp"
#include "removed_at_end.hpp"
#include "utf8.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

constexpr auto patience = std::chrono::seconds(120);

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
  const fs::path place = fs::temp_directory_path(error);
  if (error) throw IoError("printing needs a folder for temporary files, and TMPDIR names none");
  return place;
}

/// A folder of its own for the browser's settings, which it would else look for at home.
class Profile {
 public:
  Profile() {
    const fs::path place = temporary_place();
    sweep_profiles(place);
    // Another run may sweep a new folder in the moment before it is locked; then there is the next one.
    constexpr int attempts = 10;
    for (int attempt = 0; attempt < attempts && !(lock_ && lock_->is_held()); ++attempt) {
      lock_.reset();
      std::string name = (place / profile_prefix).string() + "XXXXXX";
      if (!::mkdtemp(name.data()))
        throw IoError("cannot make a folder in " + place.string() + ": " + std::strerror(errno));
      folder_.emplace(name);
      lock_.emplace(name);
    }
  }
  const fs::path& path() const { return folder_->path(); }

 private:
  std::optional<Lock> lock_;
  std::optional<RemovedAtEnd> folder_;  // goes first, while it is locked
};

/// A busy machine may print the page before it has drawn itself; only then does its title, which the PDF takes over in
/// UTF-16 as hexadecimal digits, end with the word "printed".
bool is_complete(const std::string& pdf) { return pdf.find("007000720069006E007400650064>") != std::string::npos; }

/// Sets the dates that the browser writes to one and the same: equal pages shall be equal bytes.
void take_dates_out(std::string& pdf) {
  constexpr std::string_view same = "20000101000000";
  for (const std::string_view key : {"/CreationDate (D:", "/ModDate (D:"})
    if (const std::size_t at = pdf.find(key); at != std::string::npos && at + key.size() + same.size() < pdf.size())
      pdf.replace(at + key.size(), same.size(), same);
}

}  // namespace

fs::path find_browser() {
  const char* path = std::getenv("PATH");
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    TextInput folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
      if (const fs::path file = fs::path(folder) / name; access(file.c_str(), X_OK) == 0) return file;
  }
  throw IoError("printing needs Chromium, and PATH holds none (on Debian: apt-get install chromium)");
}

void print_page(const fs::path& html, const fs::path& pdf, const std::stop_token& stop, PageKind kind) {
  const Profile profile;
  const fs::path printed = profile.path() / "page.pdf";
  std::vector<std::string> words{find_browser().string(),
                                 "--headless",
                                 "--user-data-dir=" + profile.path().string(),
                                 "--no-first-run",
                                 "--disable-extensions",
                                 "--disable-background-networking",
                                 "--use-angle=swiftshader",
                                 "--enable-unsafe-swiftshader",
                                 "--no-pdf-header-footer",
                                 "--run-all-compositor-stages-before-draw",
                                 "--virtual-time-budget=20000",
                                 "--print-to-pdf=" + printed.string()};
  if (geteuid() == 0) words.push_back("--no-sandbox");  // it refuses to run as root otherwise
  words.push_back("file://" + address_of(fs::absolute(html).string()) + "#print");
  for (int attempt = 0; attempt < 3; ++attempt) {
    const std::optional<int> code = run_quietly(words, profile.path(), patience, stop);
    if (code != 0 || !fs::exists(printed) || fs::file_size(printed) == 0)
      throw IoError(pdf.string() + ": " + words[0] + (code ? " could not print the report" : " did not finish"));
    std::string bytes = io::text_of_file(printed);
    if (kind == PageKind::drawn && !is_complete(bytes)) continue;
    take_dates_out(bytes);
    return io::write_file(pdf, bytes);
  }
  throw IoError(pdf.string() + ": " + words[0] + " printed the report before it was drawn, three times");
}

}  // namespace dynasurf::app
