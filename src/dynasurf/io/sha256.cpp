#include <algorithm>
#include <span>
#include <vector>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/digest.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {

std::string hexadecimal(const Sha256& digest) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : digest) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

std::string sha256_of(std::string_view bytes) {
  Hasher hasher;
  hasher.add(bytes.data(), bytes.size());
  return hexadecimal(hasher.finish());
}

std::string sha256_of_file(const std::filesystem::path& path) {
  FileWindow file(path);
  Hasher hasher;
  std::vector<std::byte> block(1 << 16);
  for (std::uint64_t at = 0; at < file.size(); at += block.size()) {
    const std::span part = std::span(block).first(std::min<std::uint64_t>(block.size(), file.size() - at));
    file.read(at, part, "content");
    hasher.add(part.data(), part.size());
  }
  return hexadecimal(hasher.finish());
}

}  // namespace dynasurf::io
