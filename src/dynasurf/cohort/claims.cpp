#include "dynasurf/cohort/detail/claims.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/digest.hpp"

namespace dynasurf::cohort {
namespace {

/// Locks of the open file, not of the process: they do not vanish when another descriptor of the file is closed.
struct flock lock_of(short type, off_t start, off_t length) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_start = start;
  lock.l_len = length;
  return lock;
}

off_t place_of_claim(std::string_view name) {
  io::Hasher hasher;
  hasher.add(name.data(), name.size());
  const io::Sha256 hash = hasher.finish();
  std::uint64_t place = 0;
  for (std::size_t n = 0; n < 8; ++n) place = place << 8 | hash[n];
  return place >> 2;  // far from where offsets end
}

[[noreturn]] void fail_to_lock(const std::filesystem::path& path, int code) {
  throw IoError(path.string() + ": cannot be locked: " + std::strerror(code) +
                "; expected a file system with locks (NFS 4, or a local one)");
}

}  // namespace

Claims::Claims(const std::filesystem::path& file)
    : path_(file), file_(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)) {
  if (file_.fd < 0) io::staging::fail(file, "open this file", errno);
}

bool Claims::take(std::string_view name) {
  struct flock lock = lock_of(F_WRLCK, place_of_claim(name), 1);
  if (::fcntl(file_.fd, F_OFD_SETLK, &lock) == 0) return true;
  if (errno != EAGAIN && errno != EACCES) fail_to_lock(path_, errno);
  return false;
}

void Claims::release(std::string_view name) {
  struct flock lock = lock_of(F_UNLCK, place_of_claim(name), 1);
  if (::fcntl(file_.fd, F_OFD_SETLK, &lock) != 0) fail_to_lock(path_, errno);
}

FileLock::FileLock(int descriptor, const std::filesystem::path& path) : descriptor_(descriptor) {
  struct flock lock = lock_of(F_WRLCK, 0, 0);
  while (::fcntl(descriptor_, F_OFD_SETLKW, &lock) != 0)
    if (errno != EINTR) fail_to_lock(path, errno);
}

FileLock::~FileLock() {
  struct flock lock = lock_of(F_UNLCK, 0, 0);
  ::fcntl(descriptor_, F_OFD_SETLK, &lock);
}

}  // namespace dynasurf::cohort
