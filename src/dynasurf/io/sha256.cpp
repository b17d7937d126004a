#include <algorithm>
#include <memory>
#include <span>
#include <vector>

// The functions of OpenSSL 1: those of OpenSSL 3 look their algorithm up in tables that they make at the first call,
// and crash (3.0) when memory runs out while they do. These take none.
#define OPENSSL_SUPPRESS_DEPRECATED
#include <openssl/sha.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/digest.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf {
struct Hasher::State {
  SHA256_CTX context;
};

Hasher::Hasher() : state_(std::make_unique<State>()) { SHA256_Init(&state_->context); }
Hasher::~Hasher() = default;

void Hasher::add(const void* data, std::size_t bytes) { SHA256_Update(&state_->context, data, bytes); }

Sha256 Hasher::finish() {
  Sha256 digest{};
  SHA256_Final(digest.data(), &state_->context);
  return digest;
}

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

}  // namespace dynasurf
