// SHA-256 as FIPS 180-4 says it: takes the place of sha256_openssl.cpp with DYNASURF_WITH_OPENSSL=OFF.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>

#include "dynasurf/io/detail/digest.hpp"

namespace dynasurf::io {
namespace {

using Words = std::array<std::uint32_t, 8>;
using Block = std::array<unsigned char, 64>;

/// The fractional parts of the cube roots of the first 64 primes (4.2.2).
constexpr std::array<std::uint32_t, 64> constants{
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

/// The message schedule (6.2.2, step 1), words of a block being big-endian.
std::array<std::uint32_t, 64> schedule_of(const Block& block) {
  std::array<std::uint32_t, 64> w{};
  for (std::size_t t = 0; t < 16; ++t)
    for (std::size_t byte = 0; byte < 4; ++byte) w[t] = w[t] << 8 | block[4 * t + byte];
  for (std::size_t t = 16; t < 64; ++t) {
    const std::uint32_t a = w[t - 15], b = w[t - 2];
    w[t] = w[t - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3) + w[t - 7] +
           (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10);
  }
  return w;
}

void mix(Words& hash, const Block& block) {
  const auto w = schedule_of(block);
  auto [a, b, c, d, e, f, g, h] = hash;
  for (std::size_t t = 0; t < 64; ++t) {
    // T1 and T2 of step 3: Sigma1 and Ch, then Sigma0 and Maj.
    const std::uint32_t first =
        h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & f) ^ (~e & g)) + constants[t] + w[t];
    const std::uint32_t second =
        (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + first, d = c, c = b, b = a, a = first + second;
  }
  const Words mixed{a, b, c, d, e, f, g, h};
  for (std::size_t n = 0; n < hash.size(); ++n) hash[n] += mixed[n];
}

}  // namespace

struct Hasher::State {
  // The fractional parts of the square roots of the first eight primes (5.3.3).
  Words hash{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  Block block{};
  std::uint64_t bytes = 0;
};

Hasher::Hasher() : state_(std::make_unique<State>()) {}
Hasher::~Hasher() = default;

void Hasher::add(const void* data, std::size_t bytes) {
  const auto* at = static_cast<const unsigned char*>(data);
  while (bytes > 0) {
    const std::size_t held = state_->bytes % state_->block.size();
    const std::size_t taken = std::min(bytes, state_->block.size() - held);
    std::copy_n(at, taken, state_->block.begin() + held);
    state_->bytes += taken;
    at += taken;
    bytes -= taken;
    if (held + taken == state_->block.size()) mix(state_->hash, state_->block);
  }
}

Sha256 Hasher::finish() {
  // The length of the message alone: what fills up the last block (5.1.1) passes through add() and is counted there.
  const std::uint64_t bits = state_->bytes * 8;
  constexpr unsigned char end = 0x80, nothing = 0;
  add(&end, 1);
  while (state_->bytes % state_->block.size() != 56) add(&nothing, 1);
  std::array<unsigned char, 8> length{};
  for (std::size_t n = 0; n < length.size(); ++n) length[n] = static_cast<unsigned char>(bits >> (56 - 8 * n));
  add(length.data(), length.size());
  Sha256 digest{};
  for (std::size_t n = 0; n < digest.size(); ++n)
    digest[n] = static_cast<unsigned char>(state_->hash[n / 4] >> (24 - 8 * (n % 4)));
  return digest;
}

}  // namespace dynasurf::io
