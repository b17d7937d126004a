#include <algorithm>
#include <cmath>
#include <cstdint>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/report/detail/numbers.hpp"
#include "dynasurf/report/measures.hpp"

namespace dynasurf::report {
namespace {

using detail::text_of;

constexpr double radius = 100;  // of the map in the picture

struct Rgb {
  double r, g, b;
};

/// Blue to yellow, even to the eye and to those who do not see red and green (viridis, at nine places).
constexpr Rgb even_colours[] = {{68, 1, 84},    {72, 40, 120},  {62, 74, 137},  {49, 104, 142}, {38, 130, 142},
                                {31, 158, 137}, {53, 183, 121}, {144, 215, 67}, {253, 231, 37}};
/// A circle of colours for angles (romaO's course).
constexpr Rgb circle_colours[] = {{116, 57, 90},   {159, 86, 52},  {199, 150, 76}, {214, 219, 159},
                                  {150, 205, 196}, {90, 152, 192}, {86, 94, 153},  {116, 57, 90}};

/// Blue over a pale middle to red, for differences (vik's course).
constexpr Rgb difference_colours[] = {{0, 47, 108},    {33, 102, 172}, {113, 168, 208}, {240, 238, 234},
                                      {221, 152, 116}, {178, 62, 30},  {89, 0, 8}};

template <std::size_t N>
Rgb between(const Rgb (&colours)[N], double share) {
  const double place = std::clamp(share, 0.0, 1.0) * (N - 1);
  const auto low = std::min<std::size_t>(place, N - 2);
  const double part = place - low;
  const Rgb &a = colours[low], &b = colours[low + 1];
  return {a.r + part * (b.r - a.r), a.g + part * (b.g - a.g), a.b + part * (b.b - a.b)};
}

Rgb colour_of(double share, const PolarKind& kind) {
  if (kind.is_difference) return between(difference_colours, share);
  return kind.is_cyclic ? between(circle_colours, share) : between(even_colours, share);
}

std::string hex(const Rgb& c) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text = "#";
  for (const double v : {c.r, c.g, c.b}) {
    const unsigned byte = std::lround(std::clamp(v, 0.0, 255.0));
    text += digits[byte >> 4], text += digits[byte & 15u];
  }
  return text;
}

/// Text must be read on every colour.
std::string_view ink_on(const Rgb& c) { return 0.3 * c.r + 0.59 * c.g + 0.11 * c.b > 140 ? "#111" : "#fff"; }

std::string point(double rho, double angle_deg) {
  return text_of(radius * rho * own::cos(angle_deg * degrees), 2) + " " +
         text_of(-radius * rho * own::sin(angle_deg * degrees), 2);
}

/// The outline of a piece of a ring; whole rings as two arcs each.
std::string piece(double rho_low, double rho_high, double from_deg, double width_deg) {
  const auto arc = [](double rho, double to_deg, bool back) {
    return "A" + text_of(radius * rho, 2) + " " + text_of(radius * rho, 2) + " 0 0 " + (back ? "1 " : "0 ") +
           point(rho, to_deg);
  };
  if (width_deg >= 360) {
    std::string path = "M" + point(rho_high, 0) + arc(rho_high, 180, false) + arc(rho_high, 360, false) + "Z";
    if (rho_low > 0) path += "M" + point(rho_low, 0) + arc(rho_low, 180, false) + arc(rho_low, 360, false) + "Z";
    return path;
  }
  const double to = from_deg + width_deg;
  std::string path = "M" + point(rho_low, from_deg) + "L" + point(rho_high, from_deg) + arc(rho_high, to, false) + "L" +
                     point(rho_low, to);
  if (rho_low > 0) path += arc(rho_low, from_deg, true);
  return path + "Z";
}

struct Scale {
  double low, high;
  double share(double value) const { return high > low ? (value - low) / (high - low) : 0.5; }
};

Scale scale_of(const PolarKind& kind, const ventricle::PolarValues& values) {
  Scale scale{kind.low.value_or(0), kind.high.value_or(1)};
  bool is_first = true;
  for (const auto& v : values) {
    if (!v || (kind.low && kind.high)) continue;
    if (!kind.low) scale.low = is_first ? std::floor(*v) : std::min(scale.low, std::floor(*v));
    if (!kind.high) scale.high = is_first ? std::ceil(*v) : std::max(scale.high, std::ceil(*v));
    is_first = false;
  }
  return scale;
}

std::string cells(const ventricle::PolarGrid& grid, const ventricle::PolarValues& values, const Scale& scale,
                  const PolarKind& kind) {
  std::string svg;
  const double width = 360.0 / grid.sectors;
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector) {
      const auto& value = values[grid.index(ring, sector)];
      if (!value) continue;
      const std::string colour = hex(colour_of(scale.share(*value), kind));
      // Cells overlap a little, or the page would shine through.
      svg += "<path d=\"" + piece(1.0 * ring / grid.rings, (ring + 1.0) / grid.rings, sector * width, width + 0.4) +
             "\" fill=\"" + colour + "\"/>\n";
    }
  return svg;
}

/// Mean of what a segment's samples show: along the circle for angles.
std::optional<double> mean_in(const ventricle::Measures& m, const PolarKind& kind, int number) {
  const ventricle::PolarValues& values = m.maps.*kind.values;
  double sum = 0, c = 0, s = 0, weight = 0;
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (!values[n] || ventricle::segment_at(m.model, m.grid.point(n)) != number) continue;
    const double w = m.area_mm2[n];
    sum += w * *values[n], weight += w;
    c += w * own::cos(*values[n] * degrees), s += w * own::sin(*values[n] * degrees);
  }
  if (!(weight > 0)) return std::nullopt;
  if (!kind.is_cyclic) return sum / weight;
  const double angle = own::atan2(s, c) / degrees;
  return angle < 0 ? angle + 360 : angle;
}

std::string segments(const ventricle::Measures& m, const PolarKind& kind, const Scale& scale) {
  std::string svg;
  for (const ventricle::Segment& s : ventricle::segments_of(m.model)) {
    svg += "<path d=\"" + piece(s.rho_low, s.rho_high, s.middle_deg - s.width_deg / 2, s.width_deg) +
           "\" fill=\"none\" stroke=\"" + (kind.is_difference ? "#888" : "#fff") +
           "\" stroke-width=\"0.8\" data-segment=\"" + std::to_string(s.number) + "\"><title>" +
           std::to_string(s.number) + " " + std::string(s.name) + "</title></path>\n";
    const auto mean = mean_in(m, kind, s.number);
    if (!mean) continue;
    const double rho = s.rho_low == 0 && s.width_deg >= 360 ? 0 : (s.rho_low + s.rho_high) / 2;
    const double x = radius * rho * own::cos(s.middle_deg * degrees);
    const double y = -radius * rho * own::sin(s.middle_deg * degrees);
    svg += "<text x=\"" + text_of(x, 1) + "\" y=\"" + text_of(y + 3, 1) + "\" fill=\"" +
           std::string(ink_on(colour_of(scale.share(*mean), kind))) + "\">" +
           text_of(std::abs(*mean) < 0.5 ? 0 : *mean, 0) + "</text>\n";
  }
  return svg;
}

std::string colour_bar(const Scale& scale, const PolarKind& kind) {
  std::string svg;
  constexpr int steps = 48;
  for (int n = 0; n < steps; ++n)
    svg += "<rect x=\"118\" y=\"" + text_of(80 - 160.0 * (n + 1) / steps, 2) + "\" width=\"8\" height=\"3.6\" fill=\"" +
           hex(colour_of((n + 0.5) / steps, kind)) + "\"/>";
  for (int n = 0; n <= 4; ++n)
    svg += "<text class=\"side\" x=\"129\" y=\"" + text_of(83 - 40.0 * n, 1) + "\">" +
           text_of(scale.low + (scale.high - scale.low) * n / 4, 0) + "</text>\n";
  return svg;
}

/// Of these pictures alone: on a page a style holds for everything.
constexpr std::string_view svg_style =
    "<style>.polar text{font:8px sans-serif;text-anchor:middle}.polar .side{text-anchor:start;fill:#444}"
    ".polar .head{font-size:10px;font-weight:600;fill:#111}.polar .wall{fill:#444}</style>\n";

std::string histogram(const ventricle::PhaseSummary& s, std::string_view title, double top) {
  const double highest = *std::max_element(s.histogram_percent.begin(), s.histogram_percent.end());
  std::string svg = "<text class=\"head\" x=\"180\" y=\"" + text_of(top + 12, 1) + "\">" + std::string(title) +
                    ": mean " + text_of(s.mean_deg, 0) + ", SD " + text_of(s.sd_deg, 1) + ", bandwidth " +
                    text_of(s.bandwidth_deg, 0) + " degrees, entropy " + text_of(s.entropy_percent, 0) + " %</text>\n";
  const double bottom = top + 100;
  for (std::size_t n = 0; n < s.histogram_percent.size(); ++n) {
    const double height = 80 * s.histogram_percent[n] / highest;
    if (height <= 0) continue;
    const double from = n * s.bin_deg;
    svg += "<rect x=\"" + text_of(from, 1) + "\" y=\"" + text_of(bottom - height, 2) + "\" width=\"" +
           text_of(s.bin_deg - 0.6, 1) + "\" height=\"" + text_of(height, 2) + "\" fill=\"" +
           hex(between(circle_colours, from / 360)) + "\"><title>" + text_of(from, 0) + " to " +
           text_of(from + s.bin_deg, 0) + ": " + text_of(s.histogram_percent[n], 1) + " %</title></rect>\n";
  }
  svg += "<path d=\"M0 " + text_of(bottom, 1) + "H360\" stroke=\"#444\" stroke-width=\"0.6\"/>\n";
  for (int deg = 0; deg <= 360; deg += 90)
    svg += "<text class=\"wall\" x=\"" + std::to_string(deg) + "\" y=\"" + text_of(bottom + 10, 1) + "\">" +
           std::to_string(deg) + "</text>\n";
  return svg;
}

}  // namespace

std::string polar_svg(const ventricle::Measures& m, const PolarKind& kind) {
  const ventricle::PolarValues& values = m.maps.*kind.values;
  const Scale scale = scale_of(kind, values);
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"polar\" viewBox=\"-125 -130 285 255\" width=\"570\" "
      "height=\"510\" "
      "role=\"img\">\n";
  svg += svg_style;
  std::string title(kind.title);
  if (m.from_edges && kind.name.starts_with("thick")) title += " (apparent)";
  svg += "<text class=\"head\" x=\"0\" y=\"-118\">" + title + ", " + std::string(kind.unit) + "</text>\n";
  if (values.size() == m.grid.size()) svg += cells(m.grid, values, scale, kind);
  svg += segments(m, kind, scale);
  svg +=
      "<text class=\"wall\" x=\"0\" y=\"-104\">anterior</text><text class=\"wall\" x=\"0\" y=\"113\">inferior"
      "</text><text class=\"wall\" transform=\"translate(-106 0) rotate(-90)\">septal</text>"
      "<text class=\"wall\" transform=\"translate(112 0) rotate(-90)\">lateral</text>\n";
  return svg + colour_bar(scale, kind) + "</svg>\n";
}

std::string phase_histogram_svg(const ventricle::Measures& m) {
  if (!m.phase_counts && !m.phase_motion) return "";
  const double height = m.phase_counts && m.phase_motion ? 250 : 125;
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"polar\" viewBox=\"-15 -5 390 " +
                    text_of(height, 0) + "\" width=\"780\" role=\"img\">\n" + std::string(svg_style);
  double top = 0;
  if (m.phase_counts) svg += histogram(*m.phase_counts, "Onset by counts", top), top += 122;
  if (m.phase_motion) svg += histogram(*m.phase_motion, "Onset by motion", top);
  return svg + "</svg>\n";
}

}  // namespace dynasurf::report
