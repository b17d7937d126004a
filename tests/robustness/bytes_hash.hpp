#pragma once
#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf {

/// FNV-1a of everything that is put in.
class Hash {
 public:
  template <class T>
  requires std::is_arithmetic_v<T> Hash& operator<<(T value) {
    std::array<unsigned char, sizeof(T)> bytes;
    __builtin_memcpy(bytes.data(), &value, sizeof value);
    for (const unsigned char b : bytes) state_ = (state_ ^ b) * 0x100000001b3;
    return *this;
  }
  Hash& operator<<(const Vec3& v) { return *this << v[0] << v[1] << v[2]; }
  template <class T, std::size_t n>
  Hash& operator<<(const std::array<T, n>& values) {
    for (const T& v : values) *this << v;
    return *this;
  }
  template <class T>
  Hash& operator<<(const std::vector<T>& values) {
    *this << static_cast<std::uint64_t>(values.size());
    for (const T& v : values) *this << v;
    return *this;
  }
  template <class T>
  Hash& operator<<(const std::optional<T>& value) {
    return value ? *this << true << *value : *this << false;
  }
  void print(const std::string& name) const {
    std::printf("%-28s %016llx\n", name.c_str(), static_cast<unsigned long long>(state_));
    std::fflush(stdout);
  }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};

}  // namespace dynasurf
