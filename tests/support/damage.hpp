#pragma once
#include <random>
#include <string>

namespace dynasurf::test {

/// A file with one to four bytes changed, doubled or lost; may end up empty.
inline std::string damaged(std::string bytes, std::mt19937& random) {
  for (std::uint32_t changes = 1 + random() % 4; changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = random() % bytes.size();
    switch (random() % 4) {
      case 0:
        bytes[at] = static_cast<char>(random() % 256);
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        break;
      case 2:
        bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 8));
        break;
      case 3:
        bytes.erase(at, random() % 8 + 1);
        break;
    }
  }
  return bytes;
}

}  // namespace dynasurf::test
