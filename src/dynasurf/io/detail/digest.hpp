#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace dynasurf::io {

using Sha256 = std::array<unsigned char, 32>;

/// SHA-256 of bytes that arrive in pieces.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;

  void add(const void* data, std::size_t bytes);
  Sha256 finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// 64 hexadecimal digits, lower case.
std::string hexadecimal(const Sha256& digest);
std::string sha256_of(std::string_view bytes);

}  // namespace dynasurf::io
