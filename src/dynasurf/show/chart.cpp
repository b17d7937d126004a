#include "dynasurf/show/detail/chart.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/show/detail/palette.hpp"

namespace dynasurf::show {

Interval interval_of(std::span<const double> values) {
  bool any = false;
  Interval found;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    found = any ? Interval{std::min(found.low, v), std::max(found.high, v)} : Interval{v, v};
    any = true;
  }
  if (!(found.length() > 0)) found = {found.low - 0.5, found.high + 0.5};
  return found;
}

std::vector<double> ticks_in(const Interval& interval, int count) {
  // Steps of 1, 2, 5 or 10 times a power of ten: the first that is not below nine tenths of the wanted one.
  const double rough = interval.length() / std::max(1, count);
  const double power = own::pow(10, std::floor(own::log10(rough)));
  double step = power;
  for (const double factor : {2.0, 5.0, 10.0})
    if (step < rough * 0.9) step = factor * power;
  std::vector<double> ticks;
  const double slack = 1e-9 * interval.length();  // so that rounding loses no tick at an end
  for (double n = std::ceil((interval.low - slack) / step); n * step <= interval.high + slack; ++n)
    ticks.push_back(n == 0 ? 0 : n * step);  // a negative zero would be written as -0
  return ticks;
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

void draw_axes(Canvas& canvas, const Axes& axes) {
  const Panel& b = axes.box;
  const Lettering below{9, Anchor::middle, ink_of::text}, left{9, Anchor::end, ink_of::text};
  for (const double t : ticks_in(axes.x, static_cast<int>(b.width / 70))) {
    const double x = axes.at(t, 0)[0];
    const Vec2 rule[] = {{x, b.y}, {x, b.bottom()}}, mark[] = {{x, b.bottom()}, {x, b.bottom() + 3}};
    canvas.line(rule, {ink_of::faint, 0.5});
    canvas.line(mark, {ink_of::text, 0.8});
    canvas.text({x, b.bottom() + 13}, number_text(t), below);
  }
  for (const double t : ticks_in(axes.y, std::max(2, static_cast<int>(b.height / 40)))) {
    const double y = axes.at(0, t)[1];
    const Vec2 rule[] = {{b.x, y}, {b.right(), y}}, mark[] = {{b.x - 3, y}, {b.x, y}};
    canvas.line(rule, {ink_of::faint, 0.5});
    canvas.line(mark, {ink_of::text, 0.8});
    canvas.text({b.x - 6, y + 3}, number_text(t), left);
  }
  canvas.frame(b, {ink_of::text, 0.8});
  canvas.text({b.x, b.y - 6}, axes.title, {11, Anchor::start, ink_of::text, true});
  canvas.text({b.x + b.width / 2, b.bottom() + 27}, axes.x_label, {10, Anchor::middle, ink_of::text});
  canvas.text({b.x - 36, b.y + b.height / 2}, axes.y_label, {10, Anchor::middle, ink_of::text, false, true});
}

void plot(Canvas& canvas, const Axes& axes, std::span<const Vec2> points, const Pen& pen) {
  std::vector<Vec2> drawn;
  for (const Vec2& p : points) drawn.push_back(axes.at(p[0], p[1]));
  canvas.clip(axes.box);
  canvas.line(drawn, pen);
  canvas.unclip();
}

void draw_legend(Canvas& canvas, const Vec2& at, std::span<const LegendEntry> entries) {
  double y = at[1];
  for (const LegendEntry& e : entries) {
    canvas.rectangle({at[0], y - 8, 12, 8}, e.colour);
    canvas.text({at[0] + 18, y}, e.words, {10});
    y += 16;
  }
}

void draw_legend_row(Canvas& canvas, const Vec2& at, std::span<const LegendEntry> entries) {
  double x = at[0];
  for (const LegendEntry& e : entries) {
    canvas.rectangle({x, at[1] - 8, 12, 8}, e.colour);
    canvas.text({x + 17, at[1]}, e.words, {10});
    x += 17 + canvas.width_of(e.words, {10}) + 16;
  }
}

void draw_colour_bar(Canvas& canvas, const Panel& box, const Interval& values, const std::string& label,
                     const std::function<io::Colour(double)>& colour) {
  constexpr int steps = 64;
  io::Picture bar(1, steps);
  for (int n = 0; n < steps; ++n) bar(0, n) = colour(1 - (n + 0.5) / steps);  // rows run downwards, values upwards
  canvas.raster(bar, box, true);
  canvas.frame(box, {ink_of::text, 0.6});
  for (const double t : ticks_in(values, 4)) {
    const double y = box.bottom() - (t - values.low) / values.length() * box.height;
    const Vec2 mark[] = {{box.right(), y}, {box.right() + 3, y}};
    canvas.line(mark, {ink_of::text, 0.8});
    canvas.text({box.right() + 5, y + 3}, number_text(t), {9});
  }
  canvas.text({box.right() + 40, box.y + box.height / 2}, label, {10, Anchor::middle, ink_of::text, false, true});
}

}  // namespace dynasurf::show
