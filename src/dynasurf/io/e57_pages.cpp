#include <algorithm>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/e57_parts.hpp"

namespace dynasurf::io::detail::e57 {
namespace {

constexpr std::size_t page_bytes = 1024, page_content = page_bytes - 4;

/// CRC-32C (Castagnoli), four bytes at a time.
constexpr std::array<std::array<std::uint32_t, 256>, 4> crc_tables = [] {
  std::array<std::array<std::uint32_t, 256>, 4> tables{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t crc = n;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0x82F63B78u : 0u);
    tables[0][n] = crc;
  }
  for (std::size_t t = 1; t < 4; ++t)
    for (std::size_t n = 0; n < 256; ++n) tables[t][n] = tables[t - 1][n] >> 8 ^ tables[0][tables[t - 1][n] & 255];
  return tables;
}();

std::uint32_t checksum_of(const char* page) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (std::size_t at = 0; at < page_content; at += 4) {
    crc ^= load<std::uint32_t>(page + at);
    crc = crc_tables[3][crc & 255] ^ crc_tables[2][crc >> 8 & 255] ^ crc_tables[1][crc >> 16 & 255] ^
          crc_tables[0][crc >> 24];
  }
  return ~crc;
}

}  // namespace

Pages::Pages(const MeshFile& file) : file_(file) {
  constexpr std::size_t header_bytes = 48;
  if (!file.bytes.starts_with("ASTM-E57"))
    refuse(file, "byte", 0, "expected an E57 file, which begins with 'ASTM-E57'");
  if (file.bytes.size() < header_bytes) refuse(file, "byte", file.bytes.size(), "the file ends in its header");
  const char* header = file.bytes.data();
  const auto major = load<std::uint32_t>(header + 8), minor = load<std::uint32_t>(header + 12);
  if (major != 1 || minor != 0)
    refuse(file, "byte", 8, "E57 version " + std::to_string(major) + "." + std::to_string(minor) + "; expected 1.0");
  if (const auto length = load<std::uint64_t>(header + 16); length != file.bytes.size())
    refuse(
        file, "byte", 16,
        "the header declares " + std::to_string(length) + " bytes; the file has " + std::to_string(file.bytes.size()));
  if (load<std::uint64_t>(header + 40) != page_bytes || file.bytes.size() % page_bytes != 0)
    refuse(file, "byte", 40, "the file is not made of pages of 1024 bytes");
  is_checked_.resize(file.bytes.size() / page_bytes);
}

std::size_t Pages::size() const { return is_checked_.size() * page_content; }

std::size_t Pages::content_at(std::uint64_t place, std::size_t told_at) const {
  if (place >= file_.bytes.size() || place % page_bytes >= page_content)
    fail(told_at, "leads to byte " + std::to_string(place) + ", where the file has no content");
  return static_cast<std::size_t>(place / page_bytes * page_content + place % page_bytes);
}

void Pages::read(std::size_t at, std::span<char> to) {
  for (std::size_t done = 0; done < to.size();) {
    const std::size_t page = (at + done) / page_content, begin = (at + done) % page_content;
    const char* bytes = file_.bytes.data() + page * page_bytes;
    // All else in the file is little-endian, but not this.
    if (!is_checked_[page] && load<std::uint32_t>(bytes + page_content, true) != checksum_of(bytes))
      refuse(file_, "byte", page * page_bytes,
             "page " + std::to_string(page + 1) + " of " + std::to_string(is_checked_.size()) +
                 " is damaged: its checksum does not fit");
    is_checked_[page] = true;
    const std::size_t count = std::min(to.size() - done, page_content - begin);
    std::copy_n(bytes + begin, count, to.begin() + static_cast<std::ptrdiff_t>(done));
    done += count;
  }
}

void Pages::fail(std::size_t at, const std::string& reason) const {
  refuse(file_, "byte", at / page_content * page_bytes + at % page_content, reason);
}

}  // namespace dynasurf::io::detail::e57
