#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace dynasurf::io {

/// Bytes of a file from an offset on, plain or unpacked from gzip on the fly, read strictly in order. Holds one small
/// buffer, whatever the file declares. Errors name the file: IoError when it cannot be opened or read, InputError when
/// it ends too early, holds more than expected, or its gzip stream is damaged (checksums included).
class ByteSource {
 public:
  enum class Packing { plain, gzip };

  ByteSource(const std::filesystem::path& path, Packing packing, std::uint64_t offset = 0);
  ~ByteSource();
  ByteSource(ByteSource&&) noexcept;

  /// Fills all of `out`; `what` names it in the error ("voxel data").
  void read(std::span<std::byte> out, const char* what);
  void skip(std::uint64_t bytes, const char* what);
  /// Throws InputError if anything follows.
  void expect_end();
  /// No more than this many bytes can follow: a bound from the size of the file, to check a header against before
  /// memory is taken.
  std::uint64_t most_bytes_left() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A regular file that is read at any place, through one small buffer: a walk forwards reads each part once, and parts
/// that are passed over are not read at all. Throws IoError when it cannot be opened or read.
class FileWindow {
 public:
  explicit FileWindow(const std::filesystem::path& path);
  ~FileWindow();
  FileWindow(FileWindow&&) noexcept;

  std::uint64_t size() const;
  /// `count` bytes from `place` on, valid until the next call. Precondition: they are in the file, and at most 4096.
  const unsigned char* at(std::uint64_t place, std::size_t count);
  /// Fills all of `out` from `place` on. Throws InputError when the file ends within; `what` names it ("a frame").
  void read(std::uint64_t place, std::span<std::byte> out, const char* what);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// True when the file starts with the gzip magic. Throws IoError.
bool is_gzip_file(const std::filesystem::path& path);

/// Size of a regular file. Throws IoError when it is absent, unreadable, or not a regular file.
std::uint64_t size_of_file(const std::filesystem::path& path);

/// The first bytes of a file, at most `count`, unpacked where it is gzip. Fewer when the file is shorter or damaged.
std::string first_bytes(const std::filesystem::path& path, std::size_t count);

/// All of a text file. Throws IoError when it cannot be read, InputError when it is larger than 64 MiB.
std::string text_of_file(const std::filesystem::path& path);

}  // namespace dynasurf::io
