#include <memory>

// The functions of OpenSSL 1: those of OpenSSL 3 look their algorithm up in tables that they make at the first call,
// and crash (3.0) when memory runs out while they do. These take none.
#define OPENSSL_SUPPRESS_DEPRECATED
#include <openssl/sha.h>

#include "dynasurf/io/detail/digest.hpp"

namespace dynasurf::io {

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

}  // namespace dynasurf::io
