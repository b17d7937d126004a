#include "target.hpp"

#include <cstdio>
#include <cstdlib>

namespace dynasurf::fuzz {

void require(bool promise, std::string_view what) {
  if (promise) return;
  std::fprintf(stderr, "broken promise: %.*s\n", static_cast<int>(what.size()), what.data());
  std::abort();
}

}  // namespace dynasurf::fuzz
