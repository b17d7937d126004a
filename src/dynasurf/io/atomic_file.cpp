#include "dynasurf/io/atomic_file.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const char* doing, int code) {
  throw IoError(path.string() + ": cannot " + doing + ": " + std::strerror(code));
}

struct Descriptor {
  int fd = -1;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

void sync_path(const fs::path& path, int flags) {
  const Descriptor file{::open(path.c_str(), flags | O_CLOEXEC)};
  if (file.fd < 0) fail(path, "open for writing to disk", errno);
  // Some file systems cannot sync a folder and say EINVAL; the content of the files is safe all the same.
  if (::fsync(file.fd) != 0 && errno != EINVAL) fail(path, "write to disk", errno);
}

void sync_folder(const fs::path& path) { sync_path(path, O_RDONLY | O_DIRECTORY); }

/// Asks the system to begin to write a file, so that syncing one file after the other finds most of it done: a file
/// system writes its journal once then, not once per file. A hint: where it is refused, syncing takes longer.
void begin_to_write(const fs::path& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.fd >= 0) ::sync_file_range(file.fd, 0, 0, SYNC_FILE_RANGE_WRITE);
}

/// Several at a time, for they wait for the disk and not for a processor.
void sync_files(const std::vector<fs::path>& files) {
  constexpr std::size_t at_once = 8;
  for (const fs::path& file : files) begin_to_write(file);
  std::array<std::exception_ptr, at_once> failures;
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < std::min(at_once, files.size()); ++t)
      threads.emplace_back([&, t] {
        try {
          for (std::size_t n = t; n < files.size(); n += at_once) sync_path(files[n], O_RDONLY);
        } catch (...) {
          failures[t] = std::current_exception();
        }
      });
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

void sync_tree(const fs::path& folder) {
  std::vector<fs::path> files, folders;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_symlink()) continue;
    if (entry.is_directory())
      folders.push_back(entry.path());
    else if (entry.is_regular_file())
      files.push_back(entry.path());
  }
  sync_files(files);
  for (const fs::path& inner : folders) sync_folder(inner);
  sync_folder(folder);
}

fs::path parent_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

std::string partial_prefix(const fs::path& destination) { return "." + destination.filename().string() + ".partial-"; }
std::string former_prefix(const fs::path& destination) { return "." + destination.filename().string() + ".former-"; }

fs::path new_name_beside(const fs::path& destination, const std::string& prefix) {
  static std::atomic<unsigned> counter{0};
  return parent_of(destination) / (prefix + std::to_string(::getpid()) + "." + std::to_string(counter++));
}

/// The process named in a leftover, or 0 when the name is not one of ours.
pid_t process_of(const std::string& name, const std::string& prefix) {
  if (name.compare(0, prefix.size(), prefix) != 0) return 0;
  pid_t process = 0;
  const char* end = name.data() + name.size();
  const auto [rest, error] = std::from_chars(name.data() + prefix.size(), end, process);
  return error == std::errc{} && (rest == end || *rest == '.') ? process : 0;
}

std::vector<fs::path> leftovers(const fs::path& destination, const std::string& prefix) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (fs::directory_iterator it(parent_of(destination), ignored), end; !ignored && it != end; it.increment(ignored)) {
    const pid_t process = process_of(it->path().filename().string(), prefix);
    if (process > 0 && ::kill(process, 0) != 0 && errno == ESRCH) found.push_back(it->path());
  }
  return found;
}

/// Removes what dead processes left. A process that died between the two renames of a replacement had moved the
/// former result aside: that one is put back first.
void clean_up_after_dead_processes(const fs::path& destination) {
  std::error_code ignored;
  for (const fs::path& former : leftovers(destination, former_prefix(destination))) {
    if (!fs::exists(destination, ignored))
      fs::rename(former, destination, ignored);
    else
      fs::remove_all(former, ignored);
  }
  for (const fs::path& partial : leftovers(destination, partial_prefix(destination))) fs::remove_all(partial, ignored);
}

void write_all(int fd, std::string_view content, const fs::path& path) {
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(path, "write", written < 0 ? errno : ENOSPC);
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// `if_exists` is O_EXCL or O_TRUNC; `name` is what errors call the file.
void write_plainly(const fs::path& path, std::string_view content, int if_exists, const fs::path& name) {
  Descriptor file{::open(path.c_str(), O_WRONLY | O_CREAT | if_exists | O_CLOEXEC, 0666)};
  if (file.fd < 0) fail(name, "create", errno);
  write_all(file.fd, content, name);
  // Quota and network file systems may report a full disk only here.
  const int status = ::close(file.fd);
  file.fd = -1;
  if (status != 0) fail(name, "write", errno);
}

/// Whether a path leads into an OutputFolder of this process: nobody looks there before it is published.
bool is_in_unpublished_folder(const fs::path& path) {
  const std::string mark = ".partial-" + std::to_string(::getpid()) + ".";
  const fs::path folder = path.parent_path();
  return std::any_of(folder.begin(), folder.end(), [&](const fs::path& part) {
    return part.native().starts_with('.') && part.native().find(mark) != std::string::npos;
  });
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

void create_parent(const fs::path& destination) {
  std::error_code error;
  fs::create_directories(parent_of(destination), error);
  if (error) throw IoError(parent_of(destination).string() + ": cannot make this folder: " + error.message());
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& destination) : destination_(resolved(destination)) {
  std::error_code ignored;
  if (fs::is_directory(destination_, ignored))
    throw IoError(destination_.string() + ": is a folder; expected the name of a file");
  create_parent(destination_);
  clean_up_after_dead_processes(destination_);
  staging_ = new_name_beside(destination_, partial_prefix(destination_));
}

OutputFile::~OutputFile() {
  if (!published_) ::unlink(staging_.c_str());
}

void OutputFile::publish() {
  sync_path(staging_, O_RDONLY);
  if (::rename(staging_.c_str(), destination_.c_str()) != 0) fail(destination_, "put the file in its place", errno);
  published_ = true;
  sync_folder(parent_of(destination_));
}

void write_file(const std::filesystem::path& path, std::string_view content) {
  if (is_in_unpublished_folder(path)) {  // whose publishing will bring it to disk, whole or not at all
    create_parent(path);
    write_plainly(path, content, O_TRUNC, path);
    return;
  }
  OutputFile output(path);
  write_plainly(output.path(), content, O_EXCL, path);
  output.publish();
}

OutputFolder::OutputFolder(const std::filesystem::path& destination, bool overwrite_any)
    : destination_(resolved(destination)) {
  create_parent(destination_);
  clean_up_after_dead_processes(destination_);
  std::error_code error;
  if (fs::exists(destination_, error)) {
    if (!fs::is_directory(destination_, error))
      throw IoError(destination_.string() + ": is a file; expected a folder to write the result to");
    const bool may_replace =
        overwrite_any || fs::is_empty(destination_, error) || fs::exists(destination_ / "results.json", error);
    if (!may_replace)
      throw IoError(destination_.string() +
                    ": this folder holds something else than a former result; choose another or an empty one");
  }
  staging_ = new_name_beside(destination_, partial_prefix(destination_));
  if (!fs::create_directory(staging_, error) || error)
    throw IoError(staging_.string() + ": cannot make this folder: " + error.message());
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!published_) fs::remove_all(staging_, ignored);
}

void OutputFolder::publish() {
  try {
    sync_tree(staging_);
  } catch (const fs::filesystem_error& error) {
    throw IoError(staging_.string() + ": cannot read back what was written: " + error.code().message());
  }
  fs::path former;  // where the replaced folder ends up
  if (::renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, destination_.c_str(), RENAME_NOREPLACE) != 0) {
    if (::renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, destination_.c_str(), RENAME_EXCHANGE) == 0) {
      former = staging_;
    } else {
      // The file system knows neither form: two plain renames, with the way back noted in the name.
      former = new_name_beside(destination_, former_prefix(destination_));
      if (::rename(destination_.c_str(), former.c_str()) != 0) {
        if (errno != ENOENT) fail(destination_, "move the former result aside", errno);
        former.clear();
      }
      if (::rename(staging_.c_str(), destination_.c_str()) != 0) {
        const int code = errno;
        if (!former.empty()) ::rename(former.c_str(), destination_.c_str());
        fail(destination_, "put the result in its place", code);
      }
    }
  }
  published_ = true;
  sync_folder(parent_of(destination_));
  std::error_code ignored;
  if (!former.empty()) fs::remove_all(former, ignored);
}

}  // namespace dynasurf
