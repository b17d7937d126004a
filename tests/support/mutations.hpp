#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/study_io.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::test {

/// The message with which `read_study` refuses a file or folder; "" when it does not. A message of several lines or
/// one that does not start with a path is a failure.
inline std::string refusal_of(const std::filesystem::path& path) {
  try {
    io::read_study(path);
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_EQ(text.find(path.parent_path().string()), 0u) << text;
    return text;
  }
  return "";
}

/// The lengths up to which a file can be cut and is still read; an InputError is the only refusal that counts.
inline std::vector<std::size_t> accepted_cuts(const std::filesystem::path& path, const std::string& bytes,
                                              std::size_t step = 1) {
  std::vector<std::size_t> accepted;
  for (std::size_t n = 0; n < bytes.size(); n += step) {
    write_bytes(path, bytes.substr(0, n));
    if (refusal_of(path).empty()) accepted.push_back(n);
  }
  return accepted;
}

/// Small generator with the same sequence everywhere (splitmix64).
struct Dice {
  std::uint64_t state;
  std::uint64_t operator()(std::uint64_t below) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return (z ^ (z >> 31)) % below;
  }
};

/// Reads `trials` copies of a file with one to four bytes changed (a flipped bit, or any other value). Returns how
/// many were refused; the others were read. Anything but an InputError escapes to the test.
inline int refused_of_flipped(const std::filesystem::path& path, const std::string& bytes, int trials,
                              std::uint64_t seed, std::size_t first = 0, std::size_t last = std::string::npos) {
  Dice dice{seed};
  const std::size_t end = std::min(last, bytes.size());
  int refused = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::string changed = bytes;
    for (std::uint64_t n = 1 + dice(4); n > 0; --n) {
      char& byte = changed[first + dice(end - first)];
      byte = static_cast<char>(dice(2) ? byte ^ (1 << dice(8)) : static_cast<char>(dice(256)));
    }
    write_bytes(path, changed);
    refused += !refusal_of(path).empty();
  }
  return refused;
}

}  // namespace dynasurf::test
