#include "dynasurf/report/detail/bland_altman.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/io/detail/vtk_xml.hpp"
#include "dynasurf/report/detail/numbers.hpp"

namespace dynasurf::report {
namespace {

using detail::text_of;

struct Dot {
  double truth = 0, difference = 0;
  std::size_t group = 0;
};

/// The pairs that can be drawn, as differences.
std::vector<Dot> dots_of(std::span<const PairedReading> readings, bool relative, std::size_t group = 0) {
  std::vector<Dot> dots;
  for (const PairedReading& r : readings) {
    if (!std::isfinite(r.truth) || !std::isfinite(r.measured) || (relative && !(r.truth > 0))) continue;
    const double difference = r.measured - r.truth;
    dots.push_back({r.truth, relative ? 100 * difference / r.truth : difference, group});
  }
  return dots;
}

Agreement agreement_of(const std::vector<Dot>& dots) {
  Agreement a;
  a.count = dots.size();
  if (dots.empty()) return a;
  const double n = dots.size();
  for (const Dot& dot : dots) a.bias += dot.difference / n;
  double squares = 0;
  for (const Dot& dot : dots) squares += (dot.difference - a.bias) * (dot.difference - a.bias);
  a.sd = dots.size() > 1 ? std::sqrt(squares / (n - 1)) : 0;
  // Limits of agreement (Bland and Altman 1986): 95 % of differences, were they normal.
  a.low = a.bias - 1.96 * a.sd;
  a.high = a.bias + 1.96 * a.sd;
  return a;
}

/// A range of round numbers with a step of 1, 2 or 5 times a power of ten.
struct Axis {
  double low = 0, high = 1, step = 0.2;

  Axis(double from, double to) {
    if (!(to - from > 1e-9)) from -= 0.5, to += 0.5;
    const double rough = (to - from) / 5, power = own::pow(10, std::floor(own::log10(rough)));
    const double digit = rough / power;
    step = power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10);
    low = step * std::floor(from / step);
    high = step * std::ceil(to / step);
  }
  double share(double value) const { return (value - low) / (high - low); }
  int steps() const { return std::lround((high - low) / step); }
  int decimals() const { return std::max(0, -floor_int(own::log10(step) + 1e-9)); }
};

constexpr double left = 64, right = 500, top = 34, bottom = 300;

struct Frame {
  Axis x, y;
  double at_x(double truth) const { return left + (right - left) * x.share(truth); }
  double at_y(double difference) const { return bottom - (bottom - top) * y.share(difference); }
};

Frame frame_of(const std::vector<Dot>& dots, const Agreement& a) {
  double least = dots[0].truth, most = least, low = std::min(a.low, 0.0), high = std::max(a.high, 0.0);
  for (const Dot& dot : dots) {
    least = std::min(least, dot.truth), most = std::max(most, dot.truth);
    low = std::min(low, dot.difference), high = std::max(high, dot.difference);
  }
  return {Axis(least, most), Axis(low, high)};
}

std::string line(double y, const char* style) {
  return "<path d=\"M" + text_of(left, 0) + " " + text_of(y, 1) + "H" + text_of(right, 0) + "\" " + style + "/>\n";
}

std::string text(double x, double y, const std::string& words, const char* anchor) {
  return "<text x=\"" + text_of(x, 1) + "\" y=\"" + text_of(y, 1) + "\" text-anchor=\"" + anchor + "\">" + words +
         "</text>\n";
}

std::string axes(const Frame& f, const AgreementPlot& plot) {
  std::string svg;
  for (int n = 0; n <= f.y.steps(); ++n) {
    const double value = f.y.low + n * f.y.step;
    svg += line(f.at_y(value), "stroke=\"#ddd\" stroke-width=\"0.6\"");
    svg += text(left - 6, f.at_y(value) + 4, text_of(value, f.y.decimals()), "end");
  }
  for (int n = 0; n <= f.x.steps(); ++n) {
    const double value = f.x.low + n * f.x.step;
    svg += text(f.at_x(value), bottom + 16, text_of(value, f.x.decimals()), "middle");
  }
  const std::string unit = io::detail::xml_text(plot.unit);
  // Bland and Altman plot over the mean of two methods; here the truth is known and stands in its place.
  svg += text((left + right) / 2, bottom + 34, "truth, " + unit, "middle");
  svg += "<text transform=\"translate(16 " + text_of((top + bottom) / 2, 0) +
         ") rotate(-90)\" text-anchor=\"middle\">measured less truth, " + (plot.relative ? "%" : unit) + "</text>\n";
  return svg;
}

/// The bias and the limits, each named at the right. Names that would overlap give way.
std::string limits(const Frame& f, const Agreement& a) {
  std::string svg = line(f.at_y(0), "stroke=\"#999\" stroke-width=\"0.8\"");
  svg += line(f.at_y(a.bias), "stroke=\"#111\" stroke-width=\"1.4\"");
  svg += line(f.at_y(a.high), "stroke=\"#111\" stroke-width=\"1\" stroke-dasharray=\"6 4\"");
  svg += line(f.at_y(a.low), "stroke=\"#111\" stroke-width=\"1\" stroke-dasharray=\"6 4\"");
  const double middle = f.at_y(a.bias);
  svg += text(right + 8, std::min(f.at_y(a.high), middle - 14) + 4, text_of(a.high, 1) + " (+1.96 SD)", "start");
  svg += text(right + 8, middle + 4, text_of(a.bias, 1) + " mean", "start");
  svg += text(right + 8, std::max(f.at_y(a.low), middle + 14) + 4, text_of(a.low, 1) + " (-1.96 SD)", "start");
  return svg;
}

/// Colours that people tell apart who do not see red and green (Okabe and Ito), and shapes for those who see none.
constexpr std::array<const char*, 6> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};
constexpr std::array<const char*, 3> shapes{"<circle r=\"3.2\"", "<path d=\"M-3 -3H3V3H-3Z\"",
                                            "<path d=\"M0 -4L4 3.2H-4Z\""};

std::string mark(double x, double y, std::size_t group) {
  return std::string(shapes[group % shapes.size()]) + " transform=\"translate(" + text_of(x, 1) + " " + text_of(y, 1) +
         ")\" fill=\"" + colours[group % colours.size()] + "\" fill-opacity=\"0.75\"/>\n";
}

std::string legend(std::span<const ReadingGroup> groups) {
  std::string svg;
  for (std::size_t n = 0; n < groups.size(); ++n) {
    const double y = bottom - 14.0 * (groups.size() - n);
    svg += mark(right + 14, y - 4, n) + text(right + 22, y, io::detail::xml_text(groups[n].name), "start");
  }
  return svg;
}

}  // namespace

Agreement agreement_of(std::span<const PairedReading> readings) { return agreement_of(dots_of(readings, false)); }
Agreement relative_agreement_of(std::span<const PairedReading> readings) {
  return agreement_of(dots_of(readings, true));
}

std::string bland_altman_svg(std::span<const ReadingGroup> groups, const AgreementPlot& plot) {
  std::vector<Dot> dots;
  for (std::size_t n = 0; n < groups.size(); ++n)
    for (const Dot& dot : dots_of(groups[n].readings, plot.relative, n)) dots.push_back(dot);
  const Agreement a = agreement_of(dots);
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 345\" width=\"960\" role=\"img\">\n"
      "<style>text{font:11px sans-serif;fill:#222}.head{font-size:14px;font-weight:600}</style>\n"
      "<rect width=\"640\" height=\"345\" fill=\"#fff\"/>\n<text class=\"head\" x=\"64\" y=\"20\">" +
      io::detail::xml_text(plot.title) + " (n = " + std::to_string(a.count) + ")</text>\n";
  if (dots.empty()) return svg + text((left + right) / 2, (top + bottom) / 2, "no readings", "middle") + "</svg>\n";
  const Frame frame = frame_of(dots, a);
  svg += axes(frame, plot);
  for (const Dot& dot : dots) svg += mark(frame.at_x(dot.truth), frame.at_y(dot.difference), dot.group);
  svg += limits(frame, a);
  if (groups.size() > 1) svg += legend(groups);
  return svg + "</svg>\n";
}

}  // namespace dynasurf::report
