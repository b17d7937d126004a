#include "dynasurf/show/detail/canvas.hpp"

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/show/detail/chart.hpp"
#include "dynasurf/show/detail/palette.hpp"

#include "pixels.hpp"

namespace dynasurf::show {
namespace {

TEST(Canvas, FillsWhatIsAskedFor) {
  Canvas canvas(60, 40);
  canvas.rectangle({10, 5, 20, 15}, ink_of::endo);
  canvas.disc({45, 25}, 8, ink_of::epi);
  const Spot box = spot_of(canvas.pixels(), ink_of::endo), disc = spot_of(canvas.pixels(), ink_of::epi);
  EXPECT_EQ(box.count, 300);
  EXPECT_EQ(box.left, 10);
  EXPECT_EQ(box.bottom, 19);
  EXPECT_NEAR(disc.x + 0.5, 45, 0.3);
  EXPECT_NEAR(disc.count, 201, 30);  // pi 8^2; its rim of 50 pixels is blended
  EXPECT_EQ(spot_of(canvas.pixels(2), ink_of::endo).count, 1200);
}

TEST(Canvas, KeepsToItsClip) {
  Canvas canvas(40, 40);
  canvas.clip({10, 10, 10, 10});
  canvas.rectangle({0, 0, 40, 40}, ink_of::endo);
  canvas.unclip();
  canvas.rectangle({30, 30, 5, 5}, ink_of::epi);
  EXPECT_EQ(spot_of(canvas.pixels(), ink_of::endo).count, 100);
  EXPECT_EQ(spot_of(canvas.pixels(), ink_of::epi).count, 25);
}

TEST(Canvas, SpreadsAPictureWithoutBlendingIt) {
  io::Picture picture(2, 1);
  picture(0, 0) = ink_of::endo;
  picture(1, 0) = ink_of::epi;
  Canvas canvas(40, 20);
  canvas.raster(picture, {0, 0, 40, 20});
  EXPECT_EQ(spot_of(canvas.pixels(), ink_of::endo).count, 400);
  EXPECT_EQ(spot_of(canvas.pixels(), ink_of::epi).left, 20);
}

TEST(Canvas, AnArrowHasItsHeadAtItsEnd) {
  Canvas canvas(100, 40);
  canvas.arrow({10, 20}, {90, 20}, {ink_of::endo, 2});
  const Spot tail = spot_of(canvas.pixels(), ink_of::endo, Panel{0, 0, 50, 40}, 90);
  const Spot head = spot_of(canvas.pixels(), ink_of::endo, Panel{80, 0, 20, 40}, 90);
  EXPECT_GT(head.height(), tail.height() + 2);
}

TEST(Canvas, WritesTheSameAsVectors) {
  Canvas canvas(60, 40);
  canvas.rectangle({10, 5, 20, 15}, ink_of::endo);
  canvas.text({5, 35}, "20 mm");
  const std::string svg = canvas.svg();
  EXPECT_NE(svg.find("<svg"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  EXPECT_EQ(svg.find("data:image"), std::string::npos) << "drawn as pixels";
  EXPECT_GT(spot_of(canvas.pixels(), ink_of::text, Panel{0, 22, 60, 18}, 60).count, 10) << "the letters";
}

TEST(Canvas, RefusesSizesThatAreNone) {
  EXPECT_THROW(Canvas(0, 10), InputError);
  EXPECT_THROW(Canvas(10, 1e9), InputError);
  EXPECT_EQ(drawing_format_of("a/b.svg"), DrawingFormat::svg);
  EXPECT_THROW(drawing_format_of("a/b.jpeg"), OptionError);
}

TEST(Palette, GrowsBrighterAllTheWay) {
  const auto light = [](const io::Colour& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; };
  for (int n = 1; n <= 20; ++n) EXPECT_GT(light(viridis(n / 20.0)), light(viridis((n - 1) / 20.0))) << n;
  EXPECT_EQ(viridis(-1), viridis(0));
  EXPECT_EQ(viridis(7), viridis(1));
}

TEST(Chart, HasRoundTicks) {
  EXPECT_EQ(ticks_in({0, 10}, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  const std::vector<double> ticks = ticks_in({-0.3, 1.2}, 3);
  ASSERT_EQ(ticks.size(), 3u);
  EXPECT_DOUBLE_EQ(ticks[1], 0.5);
  for (const double t : ticks_in({0.013, 0.087}, 4)) EXPECT_NEAR(std::remainder(t, 0.02), 0, 1e-12);
}

TEST(Chart, PlotsWhereTheScalesSay) {
  const Axes axes{{50, 10, 200, 100}, {0, 10}, {-1, 1}, "", "", ""};
  EXPECT_DOUBLE_EQ(axes.at(5, 0)[0], 150);
  EXPECT_DOUBLE_EQ(axes.at(5, 0)[1], 60);
  Canvas canvas(280, 150);
  const Vec2 line[] = {{0, 0.5}, {10, 0.5}, {10, 9}};  // the last leaves the frame
  plot(canvas, axes, line, {ink_of::good, 2});
  const Spot spot = spot_of(canvas.pixels(), ink_of::good);
  EXPECT_NEAR(spot.left, 50, 1);
  EXPECT_NEAR(spot.right, 249, 1);
  EXPECT_GE(spot.top, 10);
  EXPECT_NEAR(spot_of(canvas.pixels(), ink_of::good, Panel{60, 0, 100, 150}).y, 34.5, 0.6);
}

}  // namespace
}  // namespace dynasurf::show
