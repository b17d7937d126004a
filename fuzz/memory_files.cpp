// Files that are only memory, for the readers as they are: the linker sends their calls of open, read and the like
// here (--wrap), and what does not belong to us goes on to the system. No reader has to know, none has a second way in
// that only the fuzzer takes, and a run costs no system call.

#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "input_files.hpp"

namespace {

constexpr std::string_view our_folder = "/dynasurf-fuzz";
constexpr int first_descriptor = 1 << 20;

struct File {
  std::string name;
  std::string_view bytes;
};
struct Opened {
  const File* file = nullptr;
  std::size_t at = 0;
};
std::array<File, 16> files;
std::size_t file_count = 0;
std::array<Opened, 16> opened;

// The folder, opened to be listed: by one reader at a time.
constexpr int folder_descriptor = first_descriptor - 1;
std::size_t next_entry = 0;
dirent entry;
DIR* const folder_stream = reinterpret_cast<DIR*>(&entry);

bool is_ours(const char* path) { return std::strncmp(path, our_folder.data(), our_folder.size()) == 0; }

const File* find(const char* path) {
  const std::string_view wanted(path);
  for (std::size_t n = 0; n < file_count; ++n)
    if (files[n].name == wanted) return &files[n];
  errno = ENOENT;
  return nullptr;
}

Opened* opened_at(int descriptor) {
  if (descriptor < first_descriptor) return nullptr;
  const auto n = static_cast<std::size_t>(descriptor - first_descriptor);
  return n < opened.size() && opened[n].file != nullptr ? &opened[n] : nullptr;
}

int open_ours(const char* path) {
  const File* file = find(path);
  if (file == nullptr) return -1;
  for (std::size_t n = 0; n < opened.size(); ++n)
    if (opened[n].file == nullptr) {
      opened[n] = {file, 0};
      return first_descriptor + static_cast<int>(n);
    }
  errno = EMFILE;
  return -1;
}

int tell_size(const File& file, struct stat* facts) {
  *facts = {};
  facts->st_mode = S_IFREG | 0600;
  facts->st_size = static_cast<off_t>(file.bytes.size());
  return 0;
}

int stat_ours(const char* path, struct stat* facts) {
  if (our_folder == path) {
    *facts = {};
    facts->st_mode = S_IFDIR | 0700;
    return 0;
  }
  const File* file = find(path);
  return file == nullptr ? -1 : tell_size(*file, facts);
}

/// The files in the folder itself; none has a folder of its own.
dirent* next_entry_of_folder() {
  if (next_entry >= file_count) return nullptr;
  const std::string& name = files[next_entry++].name;
  entry = {};
  entry.d_type = DT_REG;
  name.copy(entry.d_name, sizeof entry.d_name - 1, our_folder.size() + 1);
  return &entry;
}

ssize_t read_ours(const Opened& from, std::size_t at, void* out, std::size_t count) {
  const std::string_view bytes = from.file->bytes;
  if (at >= bytes.size()) return 0;
  const std::size_t n = std::min(count, bytes.size() - at);
  std::memcpy(out, bytes.data() + at, n);
  return static_cast<ssize_t>(n);
}

}  // namespace

namespace dynasurf::fuzz {

InputFiles::InputFiles() : folder_(our_folder) {}

InputFiles::~InputFiles() {
  for (const Opened& leaked : opened)
    if (leaked.file != nullptr) {
      std::fprintf(stderr, "broken promise: a reader closes %s\n", leaked.file->name.c_str());
      std::abort();
    }
  file_count = 0;
}

std::filesystem::path InputFiles::add(const std::string& name, std::string_view bytes) {
  File& file = files.at(file_count++);
  file.name = folder_ + "/" + name;
  file.bytes = bytes;
  return file.name;
}

}  // namespace dynasurf::fuzz

// NOLINTBEGIN(bugprone-reserved-identifier): the linker makes these names.
extern "C" {
int __real_open(const char* path, int flags, ...);
int __real_openat(int at, const char* path, int flags, ...);
int __real_close(int descriptor);
DIR* __real_fdopendir(int descriptor);
dirent* __real_readdir(DIR* stream);
int __real_closedir(DIR* stream);
int __real_dirfd(DIR* stream);
int __real_fstat(int descriptor, struct stat* facts);
int __real_stat(const char* path, struct stat* facts);
int __real_lstat(const char* path, struct stat* facts);
int __real_access(const char* path, int mode);
ssize_t __real_read(int descriptor, void* out, std::size_t count);
ssize_t __real_pread(int descriptor, void* out, std::size_t count, off_t at);
off_t __real_lseek(int descriptor, off_t offset, int whence);
FILE* __real_fopen(const char* path, const char* mode);

int __wrap_open(const char* path, int flags, ...) {
  if (is_ours(path)) return open_ours(path);
  std::va_list rest;
  va_start(rest, flags);
  const int mode = (flags & O_CREAT) != 0 ? va_arg(rest, int) : 0;
  va_end(rest);
  return __real_open(path, flags, mode);
}

int __wrap_openat(int at, const char* path, int flags, ...) {
  if (is_ours(path)) return our_folder == path ? folder_descriptor : open_ours(path);
  std::va_list rest;
  va_start(rest, flags);
  const int mode = (flags & O_CREAT) != 0 ? va_arg(rest, int) : 0;
  va_end(rest);
  return __real_openat(at, path, flags, mode);
}

DIR* __wrap_fdopendir(int descriptor) {
  if (descriptor != folder_descriptor) return __real_fdopendir(descriptor);
  next_entry = 0;
  return folder_stream;
}

dirent* __wrap_readdir(DIR* stream) {
  return stream == folder_stream ? next_entry_of_folder() : __real_readdir(stream);
}

int __wrap_closedir(DIR* stream) { return stream == folder_stream ? 0 : __real_closedir(stream); }

int __wrap_dirfd(DIR* stream) { return stream == folder_stream ? folder_descriptor : __real_dirfd(stream); }

int __wrap_close(int descriptor) {
  Opened* const ours = opened_at(descriptor);
  if (ours == nullptr) return __real_close(descriptor);
  *ours = {};
  return 0;
}

int __wrap_fstat(int descriptor, struct stat* facts) {
  const Opened* const ours = opened_at(descriptor);
  return ours == nullptr ? __real_fstat(descriptor, facts) : tell_size(*ours->file, facts);
}

int __wrap_stat(const char* path, struct stat* facts) {
  return is_ours(path) ? stat_ours(path, facts) : __real_stat(path, facts);
}

int __wrap_lstat(const char* path, struct stat* facts) {
  return is_ours(path) ? stat_ours(path, facts) : __real_lstat(path, facts);
}

int __wrap_access(const char* path, int mode) {
  if (!is_ours(path)) return __real_access(path, mode);
  return find(path) == nullptr ? -1 : 0;
}

ssize_t __wrap_read(int descriptor, void* out, std::size_t count) {
  Opened* const ours = opened_at(descriptor);
  if (ours == nullptr) return __real_read(descriptor, out, count);
  const ssize_t n = read_ours(*ours, ours->at, out, count);
  ours->at += static_cast<std::size_t>(n);
  return n;
}

ssize_t __wrap_pread(int descriptor, void* out, std::size_t count, off_t at) {
  const Opened* const ours = opened_at(descriptor);
  if (ours == nullptr) return __real_pread(descriptor, out, count, at);
  return read_ours(*ours, static_cast<std::size_t>(at), out, count);
}

off_t __wrap_lseek(int descriptor, off_t offset, int whence) {
  Opened* const ours = opened_at(descriptor);
  if (ours == nullptr) return __real_lseek(descriptor, offset, whence);
  const off_t from = whence == SEEK_SET   ? 0
                     : whence == SEEK_CUR ? static_cast<off_t>(ours->at)
                                          : static_cast<off_t>(ours->file->bytes.size());
  if (offset < -from) {
    errno = EINVAL;
    return -1;
  }
  ours->at = static_cast<std::size_t>(from + offset);
  return from + offset;
}

FILE* __wrap_fopen(const char* path, const char* mode) {
  if (!is_ours(path)) return __real_fopen(path, mode);
  const File* file = find(path);
  // The stream only reads: the bytes are never written to.
  return file == nullptr ? nullptr : ::fmemopen(const_cast<char*>(file->bytes.data()), file->bytes.size(), "rb");
}
}
// NOLINTEND(bugprone-reserved-identifier)
