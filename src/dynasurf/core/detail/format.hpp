#pragma once
#include <array>
#include <cstdio>
#include <string>

namespace dynasurf {

/// `std::printf` into a text of at most 255 bytes.
template <class... A>
std::string format(const char* pattern, A... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

}  // namespace dynasurf
