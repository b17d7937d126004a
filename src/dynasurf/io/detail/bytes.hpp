#pragma once
#include <bit>
#include <charconv>
#include <concepts>
#include <cstring>
#include <string>
#include <string_view>

namespace dynasurf::io::detail {

// Every binary format here is little-endian on disk, and so is every machine the program is built for; only the
// readers of foreign files turn bytes round.
static_assert(std::endian::native == std::endian::little);

/// Appends the bytes of one number, little-endian.
template <class T>
requires std::is_arithmetic_v<T>
void append(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

/// Appends the shortest decimal text that reads back as the same number.
template <class T>
requires std::is_arithmetic_v<T>
void append_text(std::string& out, T value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  out.append(text, end);
}

/// The number stored at `bytes`. Precondition: sizeof(T) bytes are there.
template <class T>
requires std::is_arithmetic_v<T> T load(const char* bytes, bool big_endian = false) {
  char turned[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) turned[i] = bytes[big_endian ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, turned, sizeof(T));
  return value;
}

}  // namespace dynasurf::io::detail
