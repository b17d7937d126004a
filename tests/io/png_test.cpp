#include "dynasurf/io/detail/png.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

TEST(Png, KeepsEveryPixel) {
  const test::ScratchFolder folder;
  Picture picture(7, 5);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x)
      picture(x, y) = {static_cast<std::uint8_t>(30 * x), static_cast<std::uint8_t>(50 * y), 200};
  write_png(picture, folder.path() / "a.png");
  const Picture back = read_png(folder.path() / "a.png");
  EXPECT_EQ(back.width, 7);
  EXPECT_EQ(back.height, 5);
  EXPECT_EQ(back.pixels, picture.pixels);
}

TEST(Png, RefusesWhatIsNoPicture) {
  const test::ScratchFolder folder;
  EXPECT_THROW(write_png({}, folder.path() / "a.png"), InputError);
  EXPECT_THROW(read_png(folder.path() / "missing.png"), InputError);
  std::ofstream(folder.path() / "text.png") << "no picture";
  EXPECT_THROW(write_png(Picture(2, 2), folder.path() / "text.png" / "a.png"), IoError);
  EXPECT_THROW(read_png(folder.path() / "text.png"), InputError);
}

}  // namespace
}  // namespace dynasurf::io
