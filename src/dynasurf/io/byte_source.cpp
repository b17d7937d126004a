#include "dynasurf/io/detail/byte_source.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;

// Deflate cannot pack better than this: 258 bytes in two bits.
constexpr std::uint64_t largest_gzip_ratio = 1032;

[[noreturn]] void fail_io(const fs::path& path, const char* doing) {
  throw IoError(path.string() + ": cannot " + doing + ": " + std::strerror(errno));
}

int open_regular(const fs::path& path, std::uint64_t& size) {
  // O_NONBLOCK: a named pipe must be refused, not waited for.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) fail_io(path, "open");
  struct stat facts {};
  const bool known = ::fstat(fd, &facts) == 0;
  if (!known || !S_ISREG(facts.st_mode)) {
    ::close(fd);
    throw IoError(path.string() + ": is not a regular file");
  }
  size = facts.st_size;
  return fd;
}

}  // namespace

struct ByteSource::State {
  fs::path path;
  Packing packing;
  int fd = -1;
  std::uint64_t bytes_left_in_file = 0;
  std::uint64_t delivered = 0;
  std::array<unsigned char, 1 << 16> buffer;  // what was not read is never looked at
  std::size_t buffered_from = 0, buffered_to = 0;
  z_stream unpacker{};
  bool unpacker_ready = false;
  bool member_done = true;

  State(const fs::path& file, Packing how, std::uint64_t offset) : path(file), packing(how) {
    std::uint64_t size = 0;
    fd = open_regular(path, size);
    if (offset > size || ::lseek(fd, static_cast<off_t>(offset), SEEK_SET) < 0) {
      ::close(fd);
      throw InputError(path.string() + ": ends after " + std::to_string(size) + " bytes; its data should start at " +
                       std::to_string(offset));
    }
    bytes_left_in_file = size - offset;
    // 16: a gzip header is expected and its checksum and length are verified.
    if (packing == Packing::gzip) unpacker_ready = inflateInit2(&unpacker, 15 + 16) == Z_OK;
  }
  ~State() {
    if (unpacker_ready) inflateEnd(&unpacker);
    ::close(fd);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  bool refill() {
    if (buffered_from < buffered_to) return true;
    ssize_t count = 0;
    do count = ::read(fd, buffer.data(), buffer.size());
    while (count < 0 && errno == EINTR);
    if (count < 0) fail_io(path, "read");
    buffered_from = 0;
    buffered_to = count;
    bytes_left_in_file -= std::min<std::uint64_t>(bytes_left_in_file, buffered_to);
    return count > 0;
  }

  std::size_t take_plain(std::byte* out, std::size_t count) {
    if (!refill()) return 0;
    const std::size_t n = std::min(count, buffered_to - buffered_from);
    std::memcpy(out, buffer.data() + buffered_from, n);
    buffered_from += n;
    return n;
  }

  /// Passes over bytes of a plain file without reading them: all of them, or those that there are.
  std::uint64_t jump(std::uint64_t bytes) {
    const std::uint64_t held = buffered_to - buffered_from, beyond = std::min(bytes - held, bytes_left_in_file);
    if (::lseek(fd, static_cast<off_t>(beyond), SEEK_CUR) < 0) fail_io(path, "read");
    buffered_from = buffered_to;
    bytes_left_in_file -= beyond;
    delivered += held + beyond;
    return held + beyond;
  }

  std::size_t take_unpacked(std::byte* out, std::size_t count) {
    if (!unpacker_ready) throw IoError(path.string() + ": zlib has no memory to unpack it");
    while (true) {
      const bool more = refill();
      if (member_done) {
        if (!more) return 0;
        // A gzip file may be several members, one after the other.
        inflateReset(&unpacker);
        member_done = false;
      } else if (!more) {
        throw InputError(path.string() + ": the gzip stream is cut off; expected its end and checksum");
      }
      unpacker.next_in = buffer.data() + buffered_from;
      unpacker.avail_in = static_cast<uInt>(buffered_to - buffered_from);
      unpacker.next_out = reinterpret_cast<Bytef*>(out);
      unpacker.avail_out = static_cast<uInt>(std::min<std::size_t>(count, 1u << 30));
      const uInt room = unpacker.avail_out;
      const int status = inflate(&unpacker, Z_NO_FLUSH);
      buffered_from = buffered_to - unpacker.avail_in;
      if (status == Z_STREAM_END)
        member_done = true;
      else if (status != Z_OK && status != Z_BUF_ERROR)
        throw InputError(path.string() + ": the gzip stream is damaged (" +
                         (unpacker.msg ? unpacker.msg : "unknown reason") + ")");
      if (const std::size_t n = room - unpacker.avail_out; n > 0) return n;
    }
  }

  std::size_t take(std::byte* out, std::size_t count) {
    const std::size_t n = packing == Packing::gzip ? take_unpacked(out, count) : take_plain(out, count);
    delivered += n;
    return n;
  }
};

struct FileWindow::State {
  fs::path path;
  int fd = -1;
  std::uint64_t size = 0, begin = 0;  // of the file; where the buffer stands in it
  std::size_t held = 0;
  std::array<unsigned char, 1 << 16> buffer;

  explicit State(const fs::path& file) : path(file) { fd = open_regular(path, size); }
  ~State() { ::close(fd); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// As many bytes as there are, at most `count`.
  std::size_t fill(std::uint64_t place, unsigned char* out, std::size_t count) const {
    std::size_t done = 0;
    while (done < count) {
      const ssize_t n = ::pread(fd, out + done, count - done, static_cast<off_t>(place + done));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail_io(path, "read");
      if (n == 0) break;
      done += n;
    }
    return done;
  }
};

FileWindow::FileWindow(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {}
FileWindow::~FileWindow() = default;
FileWindow::FileWindow(FileWindow&&) noexcept = default;

std::uint64_t FileWindow::size() const { return state_->size; }

const unsigned char* FileWindow::at(std::uint64_t place, std::size_t count) {
  State& s = *state_;
  if (place < s.begin || place + count > s.begin + s.held) {
    // After a jump a little is read: the next jump may follow at once.
    const bool goes_on = place >= s.begin && place <= s.begin + s.held;
    s.held = s.fill(place, s.buffer.data(), goes_on ? s.buffer.size() : std::size_t{4096});
    s.begin = place;
    if (s.held < count) throw InputError(s.path.string() + ": became shorter while it was read");
  }
  return s.buffer.data() + (place - s.begin);
}

void FileWindow::read(std::uint64_t place, std::span<std::byte> out, const char* what) {
  const std::size_t n = state_->fill(place, reinterpret_cast<unsigned char*>(out.data()), out.size());
  if (n < out.size())
    throw InputError(state_->path.string() + ": ends within its " + what + ": " + std::to_string(out.size() - n) +
                     " more bytes were expected here");
}

ByteSource::ByteSource(const std::filesystem::path& path, Packing packing, std::uint64_t offset)
    : state_(std::make_unique<State>(path, packing, offset)) {}
ByteSource::~ByteSource() = default;
ByteSource::ByteSource(ByteSource&&) noexcept = default;

void ByteSource::read(std::span<std::byte> out, const char* what) {
  std::size_t done = 0;
  while (done < out.size()) {
    const std::size_t n = state_->take(out.data() + done, out.size() - done);
    if (n == 0)
      throw InputError(state_->path.string() + ": ends within its " + what + ": " + std::to_string(out.size() - done) +
                       " more bytes were expected here");
    done += n;
  }
}

void ByteSource::skip(std::uint64_t bytes, const char* what) {
  if (state_->packing == Packing::plain && bytes > state_->buffer.size()) bytes -= state_->jump(bytes);
  std::array<std::byte, 4096> waste{};
  while (bytes > 0) {
    const std::size_t n = std::min<std::uint64_t>(bytes, waste.size());
    read(std::span(waste).first(n), what);
    bytes -= n;
  }
}

void ByteSource::expect_end() {
  std::byte extra{};
  if (state_->take(&extra, 1) != 0)
    throw InputError(state_->path.string() + ": holds more data than its header declares (" +
                     std::to_string(state_->delivered - 1) + " bytes)");
}

std::uint64_t ByteSource::most_bytes_left() const {
  const std::uint64_t packed = state_->bytes_left_in_file + (state_->buffered_to - state_->buffered_from);
  // The unpacker may hold up to one window that it has not delivered yet.
  return state_->packing == Packing::gzip ? packed * largest_gzip_ratio + (1u << 16) : packed;
}

bool is_gzip_file(const std::filesystem::path& path) {
  std::uint64_t size = 0;
  const int fd = open_regular(path, size);
  unsigned char magic[2] = {0, 0};
  const ssize_t count = ::read(fd, magic, 2);
  ::close(fd);
  return count == 2 && magic[0] == 0x1f && magic[1] == 0x8b;
}

std::uint64_t size_of_file(const std::filesystem::path& path) {
  std::uint64_t size = 0;
  ::close(open_regular(path, size));
  return size;
}

std::string text_of_file(const std::filesystem::path& path) {
  constexpr std::uint64_t most_bytes = 64u << 20;
  const std::uint64_t size = size_of_file(path);
  if (size > most_bytes)
    throw InputError(path.string() + ": holds " + std::to_string(size) + " bytes; expected a text of at most 64 MiB");
  std::string text(size, '\0');
  ByteSource(path, ByteSource::Packing::plain).read(std::as_writable_bytes(std::span(text)), "text");
  return text;
}

std::string first_bytes(const std::filesystem::path& path, std::size_t count) {
  ByteSource source(path, is_gzip_file(path) ? ByteSource::Packing::gzip : ByteSource::Packing::plain);
  std::string bytes;
  std::byte byte{};
  try {
    while (bytes.size() < count) {
      source.read(std::span(&byte, 1), "first bytes");
      bytes += static_cast<char>(byte);
    }
  } catch (const InputError&) {
    // Too short or damaged: the caller decides by what there is.
  }
  return bytes;
}

}  // namespace dynasurf::io
