#include "dynasurf/core/detail/text_stream.hpp"

#include <new>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace dynasurf {
namespace {

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which want terabytes of addresses
/// Runs in a process of its own that may have 512 MB. Exits with 0 when std::bad_alloc came through.
template <class Work>
[[noreturn]] void exit_when_memory_ends(const Work& work) {
  const rlimit limit{rlim_t{512} << 20, rlim_t{512} << 20};
  if (::setrlimit(RLIMIT_AS, &limit) != 0) ::_exit(3);
  try {
    work();
  } catch (const std::bad_alloc&) {
    ::_exit(0);
  }
  ::_exit(1);
}

TEST(TextOutput, PassesOnThatMemoryEnds) {
  const auto write = [] {
    const std::string piece(1 << 20, 'x');
    TextOutput text;
    for (int n = 0; n < 2048; ++n) text << piece;
  };
  EXPECT_EXIT(exit_when_memory_ends(write), testing::ExitedWithCode(0), "");
}

TEST(TextInput, PassesOnThatMemoryEnds) {
  const auto read = [] {
    TextInput text(std::string(300 << 20, 'x'));
    std::string line;
    std::getline(text, line);
  };
  EXPECT_EXIT(exit_when_memory_ends(read), testing::ExitedWithCode(0), "");
}
#endif

TEST(TextInput, EndsWithoutAComplaint) {
  TextInput text("1 2");
  int sum = 0;
  for (int n = 0; text >> n;) sum += n;
  EXPECT_EQ(sum, 3);
}

}  // namespace
}  // namespace dynasurf
