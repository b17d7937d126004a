#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace dynasurf {

/// Bytes from a text such as 8G, 500M, 1.5G, 800K or a plain number; a K is 1024. Throws OptionError for anything else,
/// and below 1 MiB.
std::uint64_t memory_from_text(std::string_view text);

/// Bytes in words: "40.5 GiB", "800 MiB".
std::string memory_text(std::uint64_t bytes);

/// While it lives, at most `bytes` of memory may be asked for by `require_memory`. Held for the whole process; when
/// several live, the latest counts.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  std::uint64_t former_;
};

/// Throws InputError, naming both amounts and --memory-limit, when `bytes` are more than the limit that lives; without
/// one nothing is too much. Called with what a header declares, before memory is taken for it. `where` names the
/// file, `what` says what for: "512 x 512 x 300 voxels". From any thread.
void require_memory(std::uint64_t bytes, const std::string& where, const std::string& what);

/// Throws std::bad_alloc where the system does not give that much memory now. Asked before a library takes memory
/// without a look at whether it was given. None of it is fetched, which would cost more than most calls.
void require_room(std::size_t bytes);

}  // namespace dynasurf
