#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "dynasurf/show/detail/canvas.hpp"

namespace dynasurf::show {

struct Interval {
  double low = 0, high = 1;
  double length() const { return high - low; }
};

/// The interval of all finite values; 0 to 1 where there is none, and one unit wide around a single value.
Interval interval_of(std::span<const double> values);
/// Round numbers in the interval, about `count` of them.
std::vector<double> ticks_in(const Interval& interval, int count);
/// 12, 0.5, 1e-7: the digits that a tick needs.
std::string number_text(double value);

/// A frame with two scales, labels with units and what is plotted in it.
struct Axes {
  Panel box;
  Interval x, y;
  std::string title, x_label, y_label;

  Vec2 at(double px, double py) const {
    return {box.x + (px - x.low) / x.length() * box.width, box.bottom() - (py - y.low) / y.length() * box.height};
  }
};
void draw_axes(Canvas& canvas, const Axes& axes);
/// A line through the points, inside the frame.
void plot(Canvas& canvas, const Axes& axes, std::span<const Vec2> points, const Pen& pen);

struct LegendEntry {
  std::string words;
  io::Colour colour;
};
/// Entries one below the other, from `at` on.
void draw_legend(Canvas& canvas, const Vec2& at, std::span<const LegendEntry> entries);
/// Entries side by side, from `at` on.
void draw_legend_row(Canvas& canvas, const Vec2& at, std::span<const LegendEntry> entries);
/// An upright scale of colours with its ends and its label at the right.
void draw_colour_bar(Canvas& canvas, const Panel& box, const Interval& values, const std::string& label,
                     const std::function<io::Colour(double)>& colour);

}  // namespace dynasurf::show
