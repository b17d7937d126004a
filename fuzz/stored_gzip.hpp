#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include <zlib.h>

#include "dynasurf/io/detail/bytes.hpp"

namespace dynasurf::fuzz {

/// A gzip member that holds at most the first 65535 bytes as they are: quick to make, with a checksum that is right.
inline std::string stored_gzip(std::string_view bytes) {
  bytes = bytes.substr(0, 0xffff);
  const auto length = static_cast<std::uint16_t>(bytes.size());
  std::string out("\x1f\x8b\x08\0\0\0\0\0\0\xff\x01", 11);
  io::detail::append(out, length);
  io::detail::append(out, static_cast<std::uint16_t>(~length));
  out += bytes;
  io::detail::append(out, static_cast<std::uint32_t>(
                              crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()))));
  io::detail::append(out, std::uint32_t{length});
  return out;
}

}  // namespace dynasurf::fuzz
