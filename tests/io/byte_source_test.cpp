#include "dynasurf/io/detail/byte_source.hpp"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using test::ScratchFolder;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(TextOfFile, HoldsEveryByte) {
  const ScratchFolder scratch;
  const std::string text("a\0\r\n\xff", 5);
  write_file(scratch / "a.txt", text);
  EXPECT_EQ(text_of_file(scratch / "a.txt"), text);
  write_file(scratch / "none.txt", "");
  EXPECT_EQ(text_of_file(scratch / "none.txt"), "");
}

TEST(TextOfFile, NamesTheFileThatIsMissingOrTooLarge) {
  const ScratchFolder scratch;
  EXPECT_THAT([&] { text_of_file(scratch / "absent.json"); },
              ThrowsMessage<IoError>(HasSubstr("absent.json: cannot open: No such file")));
  write_file(scratch / "large.json", "{}");
  std::filesystem::resize_file(scratch / "large.json", (64u << 20) + 1);  // sparse: it takes no room
  EXPECT_THAT([&] { text_of_file(scratch / "large.json"); },
              ThrowsMessage<InputError>(HasSubstr("expected a text of at most 64 MiB")));
}

}  // namespace
}  // namespace dynasurf::io
