#include "chart.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "dynasurf/io/detail/atomic_file.hpp"

namespace dynasurf::experiments {
namespace {

constexpr double wide = 240, high = 170, left = 34, right = 12, top = 26, bottom = 24;
constexpr std::size_t columns = 4;
constexpr double least = 0.84, most = 0.96;  // of F1; what lies below is drawn at the bottom

template <class... A>
std::string format(const char* pattern, A... values) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

/// Values are unevenly spread, so each gets the same room.
double x_of(const Curve& c, std::size_t n) {
  const double room = wide - left - right;
  return left + room * (static_cast<double>(n) + 0.5) / static_cast<double>(c.values.size());
}

double y_of(double f1) { return top + (high - top - bottom) * (most - std::clamp(f1, least, most)) / (most - least); }

std::string line(const Curve& c, const std::vector<double>& f1, const char* colour) {
  std::string points;
  for (std::size_t n = 0; n < f1.size(); ++n) points += format("%.1f,%.1f ", x_of(c, n), y_of(f1[n]));
  std::string text = format("<polyline fill='none' stroke='%s' stroke-width='1.6' points='", colour) + points + "'/>\n";
  for (std::size_t n = 0; n < f1.size(); ++n)
    text += format("<circle cx='%.1f' cy='%.1f' r='%.1f' fill='%s'/>\n", x_of(c, n), y_of(f1[n]),
                   n == c.usual ? 3.6 : 1.8, colour);
  return text;
}

std::string panel(const Curve& c) {
  std::string text = format("<text x='%.0f' y='16' font-weight='bold'>%s</text>\n", left, c.name.c_str());
  for (const double f1 : {0.84, 0.88, 0.92, 0.96})
    text += format("<path stroke='#ddd' d='M%.0f %.1fH%.0f'/><text x='%.0f' y='%.1f' text-anchor='end'>%.2f</text>\n",
                   left, y_of(f1), wide - right, left - 4, y_of(f1) + 3.5, f1);
  for (std::size_t n = 0; n < c.values.size(); ++n)
    text += format("<text x='%.1f' y='%.0f' text-anchor='middle'>%g</text>\n", x_of(c, n), high - 8, c.values[n]);
  return text + line(c, c.choosing, "#2a6fb0") + line(c, c.reporting, "#d9772b");
}

}  // namespace

void draw_curves(const std::vector<Curve>& curves, const std::filesystem::path& file) {
  const std::size_t rows = (curves.size() + columns - 1) / columns;
  const double width = columns * wide, height = static_cast<double>(rows) * high + 24;
  std::string text = format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' viewBox='0 0 %.0f %.0f' "
      "font-family='sans-serif' font-size='10'>\n<rect width='100%%' height='100%%' fill='white'/>\n",
      width, height, width, height);
  for (std::size_t n = 0; n < curves.size(); ++n)
    text += format("<g transform='translate(%.0f %.0f)'>\n", static_cast<double>(n % columns) * wide,
                   static_cast<double>(n / columns) * high) +
            panel(curves[n]) + "</g>\n";
  text += format(
      "<text x='%.0f' y='%.0f'>Mean F1 of both borders. Blue: choosing half, orange: reporting half; the large "
      "dot is the default.</text>\n</svg>\n",
      left, height - 8);
  io::write_file(file, text);
}

}  // namespace dynasurf::experiments
