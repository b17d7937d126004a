#include <cstdint>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <zlib.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/report/detail/page_parts.hpp"

namespace dynasurf::report::detail {
namespace {

Bytes from_base64(const std::string& text) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  Bytes bytes;
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    word = word << 6U | static_cast<std::uint32_t>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<std::uint8_t>(word >> static_cast<unsigned>(bits) & 255U));
  }
  return bytes;
}

/// Slices that repeat far apart, with noise.
Bytes some_bytes(std::size_t count) {
  Bytes bytes(count);
  std::uint32_t random = 1;
  for (std::size_t n = 0; n < count; ++n) {
    random = random * 1664525U + 1013904223U;
    bytes[n] = static_cast<std::uint8_t>(n / 50 % 7 + n % 9001 % 5 + (random >> 31U));
  }
  return bytes;
}

TEST(Packed, IsAZlibStreamOfTheSameBytes) {
  constexpr std::size_t piece = std::size_t{1} << 18U;
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, piece, piece + 1, 3 * piece - 5}) {
    const Bytes bytes = some_bytes(count);
    const Bytes stream = from_base64(packed(bytes));
    Bytes back(count + 1);
    uLongf size = back.size();
    ASSERT_EQ(uncompress(back.data(), &size, stream.data(), stream.size()), Z_OK) << count;
    back.resize(size);
    EXPECT_EQ(back, bytes) << count;
    EXPECT_LT(stream.size(), count / 2 + 20);
    const ThreadLimit one(1);
    EXPECT_EQ(from_base64(packed(bytes)), stream) << count;
  }
}

}  // namespace
}  // namespace dynasurf::report::detail
