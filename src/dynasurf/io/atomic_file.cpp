#include "dynasurf/io/detail/atomic_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <exception>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/staging.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;
using staging::Descriptor;
using staging::fail;
using staging::Place;

void sync_path(const fs::path& path, int flags) {
  const Descriptor file(::open(path.c_str(), flags | O_CLOEXEC));
  if (file.fd < 0) fail(path, "open for writing to disk", errno);
  // Some file systems cannot sync a folder and say EINVAL; the content of the files is safe all the same.
  if (::fsync(file.fd) != 0 && errno != EINVAL) fail(path, "write to disk", errno);
}

void sync_folder(const fs::path& path) { sync_path(path, O_RDONLY | O_DIRECTORY); }

/// Asks the system to begin to write a file, so that syncing one file after the other finds most of it done: a file
/// system writes its journal once then, not once per file. A hint: where it is refused, syncing takes longer.
void begin_to_write(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.fd >= 0) ::sync_file_range(file.fd, 0, 0, SYNC_FILE_RANGE_WRITE);
}

/// Several at a time, for they wait for the disk and not for a processor.
void sync_files(const std::vector<fs::path>& files) {
  constexpr std::size_t at_once = 8;
  for (const fs::path& file : files) begin_to_write(file);
  std::array<std::exception_ptr, at_once> failures;
  const auto sync_share = [&](std::size_t share) {
    try {
      for (std::size_t n = share; n < files.size(); n += at_once) sync_path(files[n], O_RDONLY);
    } catch (...) {
      failures[share] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    threads.reserve(at_once);
    for (std::size_t t = 0; t < std::min(at_once, files.size()); ++t) try {
        threads.emplace_back(sync_share, t);
      } catch (const std::system_error&) {  // no thread to be had: this one does it
        sync_share(t);
      }
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

/// What a staged folder holds.
struct Tree {
  std::vector<fs::path> files, folders;
};

Tree tree_of(const fs::path& folder) try {
  Tree tree;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_symlink()) continue;
    if (entry.is_directory()) tree.folders.push_back(entry.path());
    if (entry.is_regular_file()) tree.files.push_back(entry.path());
  }
  return tree;
} catch (const fs::filesystem_error& error) {
  throw IoError(folder.string() + ": cannot read back what was written: " + error.code().message());
}

void sync_tree(const fs::path& folder, const Tree& tree) {
  sync_files(tree.files);
  for (const fs::path& inner : tree.folders) sync_folder(inner);
  sync_folder(folder);
}

fs::path parent_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

void write_all(int fd, std::string_view content, const fs::path& path) {
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(path, "write", written < 0 ? errno : ENOSPC);
    content.remove_prefix(written);
  }
}

/// `name` is what errors call the file.
void write_plainly(const fs::path& path, std::string_view content, const fs::path& name) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (file.fd < 0) fail(name, "create", errno);
  write_all(file.fd, content, name);
  // Quota and network file systems may report a full disk only here.
  const int status = ::close(file.fd);
  file.fd = -1;
  if (status != 0) fail(name, "write", errno);
}

fs::path resolved(const fs::path& destination) {
  // A link is followed, so that its target is replaced and not the link; a trailing slash must not hide the name.
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(destination), error);
  if (error) throw IoError(destination.string() + ": cannot find this place: " + error.message());
  if (!path.has_filename()) path = path.parent_path();
  if (!path.has_filename()) throw IoError(destination.string() + ": is not a name that a result can be written to");
  return path;
}

/// Makes the folders down to `folder`, as far as they are missing.
void make_folders(const fs::path& folder, staging::MadeFolders& made) {
  std::error_code error;
  for (fs::path at = folder; !fs::exists(at, error) && !error && at != at.parent_path(); at = at.parent_path())
    made.innermost_first.push_back(at);
  if (!error) fs::create_directories(folder, error);
  if (error) throw IoError(folder.string() + ": cannot make this folder: " + error.message());
}

/// The folders between a staged folder and a file in it. The staged folder itself is never made anew: where it is gone,
/// the result would be torn.
void make_folders_within(const Place& place, const fs::path& folder) {
  std::vector<fs::path> missing;
  for (fs::path at = folder; at.native().size() > place.path.native().size(); at = at.parent_path())
    missing.push_back(at);
  for (auto at = missing.rbegin(); at != missing.rend(); ++at)
    if (::mkdir(at->c_str(), 0777) != 0 && errno != EEXIST) fail(*at, "make this folder", errno);
}

// ---- What stands at the destination ----

void refuse_inputs_within(const fs::path& destination, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    std::error_code error;
    for (fs::path at = fs::weakly_canonical(fs::absolute(input), error); !error && at.has_relative_path();
         at = at.parent_path()) {
      std::error_code ignored;
      if (at == destination || fs::equivalent(at, destination, ignored))
        throw OptionError("--out " + destination.string() + ": holds the input " + input.string() +
                          "; expected another folder");
    }
  }
}

bool is_mount_point(const fs::path& folder) {
  struct stat self {
  }, parent{};
  return ::stat(folder.c_str(), &self) == 0 && ::stat(parent_of(folder).c_str(), &parent) == 0 &&
         self.st_dev != parent.st_dev;
}

/// 0 when nothing is there.
ino_t inode_of(const fs::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

bool stands_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

std::string refusal_of(const fs::path& folder, const ForeignFile& foreign) {
  return folder.string() + ": is kept, for " + foreign.name + " in it " + foreign.why +
         "; expected a new or empty folder or an untouched result, or --replace, which moves this one aside";
}

/// Throws IoError unless the folder at `destination` may be replaced in this way.
void require_replaceable(const fs::path& destination, Existing existing) {
  std::error_code error;
  const fs::file_status status = fs::status(destination, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status))
    throw IoError(destination.string() + ": is a file; expected a folder to write the result to");
  if (is_mount_point(destination))
    throw IoError(destination.string() + ": is a mount point, which cannot be replaced; expected a folder in it");
  if (existing == Existing::move_aside) return;
  if (existing == Existing::refuse && !fs::is_empty(destination, error))
    throw IoError(destination.string() + ": exists; expected a new or empty folder");
  // Another run may put its result there while this one looks: then what was seen is of two results.
  for (ino_t seen = 0; seen != inode_of(destination);) {
    seen = inode_of(destination);
    const auto foreign = first_foreign_file(destination);
    if (foreign && seen == inode_of(destination)) throw IoError(refusal_of(destination, *foreign));
  }
}

bool exchange(const fs::path& a, const fs::path& b) {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

/// Tried in `folder`, which is empty but for its manifest.
bool can_exchange(const fs::path& folder) {
  const fs::path a = folder / "a", b = folder / "b";
  for (const fs::path& one : {a, b})
    if (::mkdir(one.c_str(), 0777) != 0) fail(one, "make this folder", errno);
  const bool can = exchange(a, b) || (errno != EINVAL && errno != ENOSYS && errno != EOPNOTSUPP);
  ::rmdir(a.c_str());
  ::rmdir(b.c_str());
  return can;
}

// ---- Publishing a folder ----

/// Takes up what other writers put into the folder, and holds what was written against what is there.
void require_complete(Place& place, const Tree& tree) {
  std::map<std::string, ManifestEntry> missing = place.written;
  for (const fs::path& file : tree.files) {
    const std::string name = file.lexically_relative(place.path).string();
    if (name == manifest_name) continue;
    const auto written = missing.find(name);
    if (written == missing.end()) {
      staging::record(place, file);
      continue;
    }
    if (fs::file_size(file) != written->second.bytes)
      throw IoError(file.string() + ": was changed by somebody else before the result was complete");
    missing.erase(written);
  }
  if (!missing.empty())
    throw IoError((place.path / missing.begin()->first).string() + ": has vanished before the result was complete");
}

/// The manifest takes its place by a rename: at every moment it says "not finished" or lists everything, and is locked.
void write_manifest(Place& place) {
  const fs::path path = place.path / manifest_name, draft = path.string() + ".new";
  std::vector<ManifestEntry> files;
  for (const auto& [name, entry] : place.written) files.push_back(entry);
  const std::string text = manifest_text(std::move(files));
  Descriptor file = staging::make_locked_file(draft);
  if (file.fd < 0) fail(draft, "create", EEXIST);
  write_all(file.fd, text, draft);
  if (::rename(draft.c_str(), path.c_str()) != 0) fail(path, "put the file in its place", errno);
  std::swap(place.lock, file);
}

/// The folders of an exchange, locked until it is decided which of them stays: meanwhile no other run sweeps or
/// replaces either.
struct ExchangedFolders {
  Descriptor staged, former;
};

/// Waits for a run that is exchanging something at the same destination. What is no folder is not locked, and errno
/// says why.
ExchangedFolders lock_folders(const fs::path& staged, const fs::path& destination,
                              std::unique_lock<std::mutex>& publishing) {
  for (;;) {
    ExchangedFolders both{staging::lock_folder(staged), {}};
    if (both.staged.fd >= 0) both.former = staging::lock_folder(destination);
    if (both.former.fd >= 0 || errno != EWOULDBLOCK) return both;
    publishing.unlock();  // an end on request has its turn
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    publishing = staging::begin_to_publish();
  }
}

bool is_at(const fs::path& path, const Descriptor& folder) {
  struct stat there {
  }, opened{};
  return ::lstat(path.c_str(), &there) == 0 && ::fstat(folder.fd, &opened) == 0 && there.st_dev == opened.st_dev &&
         there.st_ino == opened.st_ino;
}

std::string appeared(const fs::path& destination) {
  return destination.string() + ": appeared while the result was made, and was kept";
}

/// Exchanges the staged folder with the former result, which then stands at the staged folder's place. What turns out
/// to be no former result is put back. `published` says at every moment which of the two stands at the destination.
void exchange_with_former(const fs::path& staged, const fs::path& destination, const ExchangedFolders& both,
                          bool& published) {
  if (both.former.fd < 0 && (errno == ENOTDIR || errno == ELOOP)) throw IoError(appeared(destination));
  if (both.former.fd < 0 || !exchange(staged, destination))
    fail(destination, "exchange this with the new result", errno);
  published = true;
  const auto put_back = [&] {
    if (is_at(destination, both.staged) && exchange(staged, destination))
      published = false;
    else
      staging::move_aside(staged, destination);
  };
  std::string reason;
  try {
    if (!is_at(staged, both.former))
      reason = appeared(destination);
    else if (const auto foreign = first_foreign_file(staged))
      reason = refusal_of(destination, *foreign);
  } catch (...) {  // out of memory
    put_back();
    throw;
  }
  if (reason.empty()) return;
  put_back();
  throw IoError(reason);
}

/// Keeps what stands at the destination under another name. Where the file system can exchange, the new result stands
/// there from one moment to the next.
fs::path put_beside_former(const fs::path& staged, const fs::path& destination) {
  fs::path beside = staging::move_aside(staged, destination);
  if (exchange(beside, destination)) return beside;
  if (::rename(beside.c_str(), staged.c_str()) != 0) fail(beside, "move the new result back", errno);
  fs::path former = staging::move_aside(destination, destination);
  if (::rename(staged.c_str(), destination.c_str()) != 0) fail(destination, "put the result in its place", errno);
  return former;
}

/// A result that stands is told from one that was not written.
void sync_parent_of(const fs::path& destination) try {
  sync_folder(parent_of(destination));
} catch (const IoError& error) {
  throw IoError(destination.string() +
                ": is written and stands there, but may not outlast a power cut: " + error.what());
}

}  // namespace

staging::MadeFolders::~MadeFolders() {
  for (const fs::path& folder : innermost_first)
    if (::rmdir(folder.c_str()) != 0) break;  // holds a result, or somebody else uses it by now
}

OutputFile::OutputFile(const std::filesystem::path& destination, Existing existing)
    : destination_(resolved(destination)), existing_(existing) {
  std::error_code ignored;
  if (fs::is_directory(destination_, ignored))
    throw IoError(destination_.string() + ": is a folder; expected the name of a file");
  if (stands_there(destination_) && !fs::is_regular_file(destination_, ignored))
    throw IoError(destination_.string() + ": is no regular file; expected a new name");
  if (existing_ == Existing::refuse && stands_there(destination_))
    throw IoError(destination_.string() + ": exists; expected a new name, or --replace, which moves this one aside");
  if (const auto within = staging::place_of(destination_)) {
    make_folders_within(*within, parent_of(destination_));
    path_ = destination_;
    return;
  }
  make_folders(parent_of(destination_), parents_);
  staging::sweep(destination_);
  place_ = staging::make_place(destination_, false);
  path_ = place_->path;
}

OutputFile::~OutputFile() {
  if (place_)
    staging::release(place_, published_);
  else if (!published_)
    ::unlink(path_.c_str());
}

void OutputFile::take_the_place() {
  if (existing_ == Existing::move_aside && stands_there(destination_))
    moved_to_ = staging::move_aside(destination_, destination_);
  if (existing_ == Existing::replace) {
    if (::rename(path_.c_str(), destination_.c_str()) != 0) fail(destination_, "put the file in its place", errno);
    return;
  }
  if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, destination_.c_str(), RENAME_NOREPLACE) == 0) return;
  if (errno != EINVAL && errno != ENOSYS) fail(destination_, "put the file in its place", errno);
  // A file system that does not know the flag: a link never takes the place of anything.
  if (::link(path_.c_str(), destination_.c_str()) != 0) fail(destination_, "put the file in its place", errno);
  ::unlink(path_.c_str());
}

void OutputFile::publish() {
  if (!place_) {
    if (const auto within = staging::place_of(path_); within && within->is_folder) staging::record(*within, path_);
    published_ = true;
    return;
  }
  sync_path(path_, O_RDONLY);
  const auto publishing = staging::begin_to_publish();
  take_the_place();
  published_ = true;
  staging::note_published();
  sync_parent_of(destination_);
}

void write_file(const std::filesystem::path& path, std::string_view content) {
  if (const auto within = staging::place_of(path)) {  // whose publishing will bring it to disk, whole or not at all
    if (within->is_folder) make_folders_within(*within, parent_of(path));
    write_plainly(path, content, path);
    if (within->is_folder) staging::record(*within, path, content);
    return;
  }
  OutputFile output(path);
  write_plainly(output.path(), content, path);
  output.publish();
}

OutputFolder::OutputFolder(const std::filesystem::path& destination, Existing existing,
                           const std::vector<std::filesystem::path>& inputs)
    : destination_(resolved(destination)), existing_(existing) {
  refuse_inputs_within(destination_, inputs);
  staging::sweep(destination_);
  require_replaceable(destination_, existing_);
  make_folders(parent_of(destination_), parents_);
  place_ = staging::make_place(destination_, true);
  path_ = place_->path;
  std::error_code ignored;
  if (existing_ == Existing::replace && stands_there(destination_) && !fs::is_empty(destination_, ignored) &&
      !can_exchange(path_)) {
    staging::release(place_, false);
    throw IoError(
        destination_.string() +
        ": this file system cannot exchange a former result for a new one in one step; expected a new folder, "
        "or --replace, which moves the former one aside");
  }
}

OutputFolder::~OutputFolder() { staging::release(place_, published_); }

void OutputFolder::publish() {
  const Tree tree = tree_of(path_);
  require_complete(*place_, tree);
  write_manifest(*place_);
  sync_tree(path_, tree);
  const bool is_outermost = !staging::place_of(destination_);
  auto publishing = staging::begin_to_publish();
  ExchangedFolders both;
  // A plain rename takes the place of nothing but an empty folder.
  if (::rename(path_.c_str(), destination_.c_str()) != 0) {
    if (existing_ == Existing::refuse || (errno != ENOTEMPTY && errno != EEXIST && errno != ENOTDIR))
      fail(destination_, "put the result in its place", errno);
    both = lock_folders(path_, destination_, publishing);
    if (existing_ == Existing::move_aside)
      moved_to_ = put_beside_former(path_, destination_);
    else
      exchange_with_former(path_, destination_, both, published_);
  }
  published_ = true;
  if (is_outermost) staging::note_published();
  // The former result goes only once the new one is known to be on the disk; else the next run sweeps it.
  sync_parent_of(destination_);
  if (stands_there(path_)) staging::remove_place(path_);
}

void discard_unpublished() noexcept { staging::discard_all(); }
OutputState state_of_outputs() noexcept { return staging::state(); }

}  // namespace dynasurf::io
