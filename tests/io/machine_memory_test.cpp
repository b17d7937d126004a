#include "dynasurf/io/detail/machine_memory.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

namespace dynasurf::io {
namespace {

TEST(MachineMemory, IsHalfOfItAtMost) {
  const auto pages = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES));
  EXPECT_LE(default_memory_limit(), pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) / 2);
  EXPECT_GT(default_memory_limit(), std::uint64_t{100} << 20) << "on a machine that can build this";
}

}  // namespace
}  // namespace dynasurf::io
