#include "dynasurf/io/detail/staging.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/digest.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io::staging {
namespace {

constexpr std::size_t name_digits = 16;

/// All places of this process.
struct Registry {
  std::mutex guard;
  std::vector<std::shared_ptr<Place>> places;
  std::mutex publishing;
  std::atomic<bool> discarded = false;
  std::atomic<OutputState> state = OutputState::none;
};

Registry& registry() {
  static auto* const all = new Registry;  // never destroyed: a thread may ask for it until the end
  return *all;
}

fs::path parent_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

std::string prefix_of(const fs::path& destination) { return "." + destination.filename().string() + ".partial-"; }

std::string random_digits() {
  std::array<unsigned char, name_digits / 2> bytes{};
  for (std::size_t have = 0; have < bytes.size();) {
    const ssize_t got = ::getrandom(bytes.data() + have, bytes.size() - have, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw IoError(std::string("cannot draw a random name: ") + std::strerror(errno));
    have += got;
  }
  std::string text;
  for (const unsigned char byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

bool is_place_name(const std::string& name, const std::string& prefix) {
  return name.size() == prefix.size() + name_digits && name.starts_with(prefix) &&
         name.find_first_not_of("0123456789abcdef", prefix.size()) == std::string::npos;
}

enum class Lock { taken, held_by_another, not_supported };

Lock try_lock(int fd) {
  while (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    return errno == EWOULDBLOCK ? Lock::held_by_another : Lock::not_supported;
  }
  return Lock::taken;
}

bool is_still_there(int fd) {
  struct stat status {};
  return ::fstat(fd, &status) == 0 && status.st_nlink > 0;
}

void write_unfinished(const Place& place) {
  const std::string text = unfinished_manifest_text();
  if (::pwrite(place.lock.fd, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()))
    fail(place.path / manifest_name, "write", errno == 0 ? ENOSPC : errno);
}

/// One try to make a place of a new name; false when somebody else was there first.
bool try_to_make(Place& place) {
  if (!place.is_folder) {
    place.lock = make_locked_file(place.path);
    return place.lock.fd >= 0;
  }
  if (::mkdir(place.path.c_str(), 0777) != 0) {
    if (errno == EEXIST) return false;
    fail(place.path, "make this folder", errno);
  }
  try {
    place.lock = make_locked_file(place.path / manifest_name);
    if (place.lock.fd < 0) return false;
    write_unfinished(place);
  } catch (...) {
    remove_place(place.path);
    throw;
  }
  return true;
}

/// Whether the manifest says that its folder was being filled; cut short when its writer died in its first line.
bool is_unfinished(const fs::path& manifest) {
  std::array<char, 64> begin{};
  const Descriptor file(::open(manifest.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  const ssize_t size = file.fd < 0 ? -1 : ::pread(file.fd, begin.data(), begin.size(), 0);
  return size >= 0 && unfinished_manifest_text().starts_with(std::string_view(begin.data(), size));
}

/// Whether a folder is one that this program staged or published: nothing in it is anyone else's.
bool is_ours(const fs::path& folder) { return is_unfinished(folder / manifest_name) || !first_foreign_file(folder); }

void sweep_file(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.fd >= 0 && try_lock(file.fd) == Lock::taken) ::unlink(path.c_str());
}

void sweep_folder(const fs::path& path, const fs::path& destination) {
  if (::rmdir(path.c_str()) == 0) return;  // died before it wrote anything
  const Descriptor folder = lock_folder(path);
  if (folder.fd < 0) return;
  // The manifest of this very folder, whatever an exchange puts at the path meanwhile.
  const Descriptor lock(::openat(folder.fd, manifest_name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (lock.fd >= 0 && try_lock(lock.fd) != Lock::taken) return;
  if (lock.fd < 0 && errno != ENOENT) return;
  if (is_ours(path))
    remove_place(path);
  else
    move_aside(path, destination);
}

void note(Place& folder, const fs::path& file, std::uint64_t bytes, std::string sha256) {
  const std::string name = fs::absolute(file).lexically_normal().lexically_relative(folder.path).string();
  const std::lock_guard lock(folder.guard);
  folder.written[name] = {name, bytes, std::move(sha256)};
}

}  // namespace

void fail(const fs::path& path, const char* doing, int code) {
  throw IoError(path.string() + ": cannot " + doing + ": " + std::strerror(code));
}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(fd, other.fd);
  return *this;
}

Descriptor::~Descriptor() {
  if (fd >= 0) ::close(fd);
}

Descriptor make_locked_file(const fs::path& path) {
  Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (file.fd < 0) {
    if (errno == ENOENT || errno == EEXIST) return {};
    fail(path, "create", errno);
  }
  if (try_lock(file.fd) == Lock::held_by_another || !is_still_there(file.fd)) return {};
  return file;
}

Descriptor lock_folder(const fs::path& path) noexcept {
  Descriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (folder.fd < 0 || try_lock(folder.fd) != Lock::held_by_another) return folder;
  errno = EWOULDBLOCK;
  return {};
}

std::shared_ptr<Place> make_place(const fs::path& destination, bool folder) {
  constexpr int tries = 100;
  auto place = std::make_shared<Place>();
  place->is_folder = folder;
  const std::lock_guard lock(registry().guard);
  if (registry().discarded) throw Cancelled("stopped on request");
  registry().places.reserve(registry().places.size() + 1);
  for (int n = 0; n < tries; ++n) {
    place->path = parent_of(destination) / (prefix_of(destination) + random_digits());
    if (!try_to_make(*place)) continue;
    registry().places.push_back(place);
    OutputState none = OutputState::none;
    registry().state.compare_exchange_strong(none, OutputState::begun);
    return place;
  }
  fail(place->path, "make a place to write to", EEXIST);
}

std::shared_ptr<Place> place_of(const fs::path& path) {
  const std::lock_guard lock(registry().guard);
  if (registry().places.empty()) return nullptr;
  const std::string text = fs::absolute(path).lexically_normal().string();
  std::shared_ptr<Place> innermost;
  for (const auto& place : registry().places) {
    const std::string& mine = place->path.native();
    if (text.starts_with(mine) && (text.size() == mine.size() || text[mine.size()] == '/') &&
        (!innermost || innermost->path.native().size() < mine.size()))
      innermost = place;
  }
  return innermost;
}

void record(Place& folder, const fs::path& file, std::string_view content) {
  note(folder, file, content.size(), sha256_of(content));
}

void record(Place& folder, const fs::path& file) { note(folder, file, fs::file_size(file), sha256_of_file(file)); }

void remove_place(const fs::path& path) noexcept try {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return;
  if (!S_ISDIR(status.st_mode)) {
    ::unlink(path.c_str());
    return;
  }
  std::error_code error;
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename() != manifest_name) fs::remove_all(it->path(), error);
    if (error) break;
  }
  if (error) return;
  ::unlink((path / manifest_name).c_str());
  ::rmdir(path.c_str());
} catch (...) {  // out of memory: the next run sweeps
}

void release(const std::shared_ptr<Place>& place, bool published) noexcept {
  if (!published) remove_place(place->path);
  const std::lock_guard lock(registry().guard);
  std::erase(registry().places, place);
}

void sweep(const fs::path& destination) noexcept try {
  const std::string prefix = prefix_of(destination);
  std::vector<fs::path> found;
  std::error_code ignored;
  for (fs::directory_iterator it(parent_of(destination), ignored), end; !ignored && it != end; it.increment(ignored))
    if (is_place_name(it->path().filename().string(), prefix)) found.push_back(it->path());
  for (const fs::path& path : found) {
    if (place_of(path)) continue;  // our own
    const fs::file_status status = fs::symlink_status(path, ignored);
    if (fs::is_regular_file(status)) sweep_file(path);
    if (fs::is_directory(status)) sweep_folder(path, destination);
  }
} catch (...) {  // what cannot be swept does not hinder this run
}

fs::path move_aside(const fs::path& from, const fs::path& destination) {
  constexpr int most = 10000;
  for (int n = 1; n <= most; ++n) {
    fs::path to = parent_of(destination) / (destination.filename().string() + ".old-" + std::to_string(n));
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return to;
    if (errno == EEXIST) continue;
    if (errno != EINVAL && errno != ENOSYS) fail(from, "move this aside", errno);
    // A file system that does not know the flag. No plain rename takes a folder that holds anything.
    std::error_code error;
    if (fs::exists(fs::symlink_status(to, error))) continue;
    if (::rename(from.c_str(), to.c_str()) == 0) return to;
    if (errno != EEXIST && errno != ENOTEMPTY && errno != ENOTDIR) fail(from, "move this aside", errno);
  }
  throw IoError(destination.string() + ": cannot be moved aside: " + std::to_string(most) + " names are taken");
}

std::unique_lock<std::mutex> begin_to_publish() {
  std::unique_lock lock(registry().publishing);
  if (registry().discarded) throw Cancelled("stopped on request");
  return lock;
}

void discard_all() noexcept try {
  const std::lock_guard publishing(registry().publishing);
  registry().discarded = true;
  const std::lock_guard lock(registry().guard);
  constexpr int tries = 50;  // other threads may still be writing
  for (const auto& place : registry().places)
    for (int n = 0; n < tries; ++n) {
      remove_place(place->path);
      std::error_code ignored;
      if (!fs::exists(fs::symlink_status(place->path, ignored))) break;
    }
} catch (...) {
}

OutputState state() noexcept { return registry().state; }
void note_published() noexcept { registry().state = OutputState::published; }

}  // namespace dynasurf::io::staging
