#include "dynasurf/core/detail/memory_limit.hpp"

#include <new>
#include <thread>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

constexpr std::uint64_t mib = std::uint64_t{1} << 20, gib = mib << 10;

std::string refusal(std::uint64_t bytes) {
  try {
    require_memory(bytes, "a.nii", "8 x 8 x 8 voxels");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MemoryLimit, IsReadFromAnAmountWithAUnit) {
  EXPECT_EQ(memory_from_text("8G"), 8 * gib);
  EXPECT_EQ(memory_from_text("500M"), 500 * mib);
  EXPECT_EQ(memory_from_text("1.5g"), gib + gib / 2);
  EXPECT_EQ(memory_from_text("2048K"), 2 * mib);
  EXPECT_EQ(memory_from_text("1TB"), 1024 * gib);
  EXPECT_EQ(memory_from_text("1048576"), mib);
  for (const char* bad : {"", "G", "8X", "-8G", "nan", "inf", "8 G", "8GiB", "1K", "0", "1e30G", "8G\n"})
    EXPECT_THROW(memory_from_text(bad), OptionError) << bad;
}

TEST(MemoryLimit, IsToldInWords) {
  EXPECT_EQ(memory_text(800 * mib), "800 MiB");
  EXPECT_EQ(memory_text(1), "1 MiB");
  EXPECT_EQ(memory_text(41 * gib + gib / 2), "41.5 GiB");
}

TEST(MemoryLimit, HoldsWhileItLivesAndInEveryThread) {
  {
    const MemoryLimit limit(10 * mib);
    EXPECT_EQ(refusal(10 * mib), "");
    EXPECT_EQ(refusal(40 * mib),
              "a.nii: needs 40 MiB of memory for 8 x 8 x 8 voxels; the limit is 10 MiB (--memory-limit)");
    std::string there;
    std::thread([&] { there = refusal(40 * mib); }).join();
    EXPECT_NE(there, "");
    const MemoryLimit inner(50 * mib);
    EXPECT_EQ(refusal(40 * mib), "");
  }
  EXPECT_EQ(refusal(std::uint64_t{1} << 62), "") << "without a limit";
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which end the program where memory ends
TEST(RequireRoom, ThrowsWhereTheSystemGivesNone) {
  EXPECT_NO_THROW(require_room(1 << 20));
  EXPECT_THROW(require_room(std::size_t{1} << 60), std::bad_alloc);
}
#endif

}  // namespace
}  // namespace dynasurf
