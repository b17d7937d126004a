#include "dynasurf/report/detail/comparison_page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/io/detail/vtk_xml.hpp"
#include "dynasurf/report/detail/numbers.hpp"
#include "dynasurf/report/detail/page_parts.hpp"
#include "dynasurf/report/measures.hpp"

namespace dynasurf::report {
namespace {

using detail::Bytes;
using detail::Json;
using detail::text_of;

constexpr std::string_view style = R"(
:root { color: #10161d; background: #fff; font: 13px/1.4 system-ui, sans-serif; }
body { max-width: 1060px; margin: 18px auto; padding: 0 14px; }
header { display: flex; justify-content: space-between; border-bottom: 2px solid #10161d; padding-bottom: 6px; }
h1 { font-size: 19px; margin: 0; } h2 { font-size: 14px; margin: 16px 0 4px; }
p { margin: 4px 0; } .use { font-weight: 600; }
table { width: 100%; border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 2px 8px; text-align: right; border-bottom: 1px solid #dde3ea; }
th:first-child { text-align: left; } thead th { color: #3d4854; font-weight: 500; }
td.lost { font-weight: 700; }
.ratios { display: grid; grid-template-columns: repeat(auto-fit, minmax(130px, 1fr)); gap: 8px; margin: 10px 0; }
.ratios div { border: 1px solid #c4ccd6; border-radius: 6px; padding: 6px 10px; }
.ratios b { display: block; font-size: 20px; }
.maps { display: grid; grid-template-columns: repeat(3, 1fr); gap: 4px 18px; break-inside: avoid; }
.maps svg { width: 100%; height: auto; } .curve svg { width: 100%; height: auto; }
figure { margin: 4px 0; } figcaption { font-weight: 600; } figure img { width: 100%; display: block; }
.sheet { break-after: page; }
@media screen and (max-width: 640px) {
  header { display: block; } th, td { padding: 2px 4px; }
  .maps { grid-template-columns: 1fr; } .maps > div { max-width: 360px; margin: 0 auto; }
}
@page { size: A4; margin: 11mm 12mm; }
@media print { body { margin: 0; padding: 0; max-width: none; font-size: 10px; } .maps svg { height: 50mm; }
  .curve svg { height: 34mm; } th, td { padding: 1px 8px; } figure { break-inside: avoid; }
  figure img { width: auto; max-width: 100%; max-height: 44mm; } }
)";

/// The slices of both studies one above the other, as they are read.
std::string slices(const ComparedStudy& rest, const ComparedStudy& stress) {
  constexpr std::string_view png_magic = "\x89PNG";
  std::string html;
  for (const auto& [name, study] : {std::pair("Rest", &rest), std::pair("Stress", &stress)}) {
    // A file of the result folder may be anything; only a PNG goes into the page.
    if (!study->splash_png.starts_with(png_magic)) continue;
    html += std::string("<figure><figcaption>") + name + "</figcaption><img alt=\"Slices of the " + name +
            " study\" src=\"data:image/png;base64," +
            detail::base64(Bytes(study->splash_png.begin(), study->splash_png.end())) + "\"></figure>\n";
  }
  return html.empty() ? html
                      : "<h2>Slices from apex to base, inner wall blue, outer wall orange; end diastole above, end "
                        "systole below</h2>\n" +
                            html;
}

/// The value at a path of keys; null where any of them is absent.
const Json* value_at(const Json& json, std::initializer_list<const char*> path) {
  const Json* at = &json;
  for (const char* key : path) {
    const auto found = at->is_object() ? at->find(key) : at->end();
    if (found == at->end()) return nullptr;
    at = &*found;
  }
  return at;
}

/// The number there; absent where there is none.
std::optional<double> number_at(const Json& json, std::initializer_list<const char*> path) {
  const Json* at = value_at(json, path);
  return at != nullptr && at->is_number() ? std::optional(at->get<double>()) : std::nullopt;
}

/// All numbers of a list at a path of keys; empty where there is none.
std::vector<double> numbers_at(const Json& json, std::initializer_list<const char*> path) {
  std::vector<double> numbers;
  if (const Json* at = value_at(json, path); at != nullptr && at->is_array())
    for (const Json& number : *at)
      if (number.is_number()) numbers.push_back(number.get<double>());
  return numbers;
}

std::string figure(const std::optional<double>& value, int decimals) {
  if (!value) return "&ndash;";
  const double unit = own::pow(10, -decimals);
  return text_of(std::abs(*value) < unit / 2 ? 0.0 : *value, decimals);  // no -0
}

/// "60.2 (58.4 to 62.1)": a number of the PSF-corrected reading with its interval.
std::string with_interval(const Json& results, const std::string& key) {
  const std::string interval = key + "_90";
  std::string text = figure(number_at(results, {"readings", "psf_corrected", key.c_str()}), 1);
  const std::vector<double> ends = numbers_at(results, {"readings", "psf_corrected", interval.c_str()});
  return ends.size() == 2 ? text + " (" + text_of(ends[0], 1) + " to " + text_of(ends[1], 1) + ")" : text;
}

std::string row(const std::string& name, const std::vector<std::string>& cells) {
  std::string html = "<tr><th scope=\"row\">" + name + "</th>";
  for (const std::string& cell : cells) html += "<td>" + cell + "</td>";
  return html + "</tr>\n";
}

std::string number_rows(const Json& rest, const Json& stress) {
  struct Named {
    const char* name;
    std::initializer_list<const char*> path;
    int decimals;
  };
  const Named lines[] = {
      {"EF, edge, %", {"readings", "edge", "ef_percent"}, 1},
      {"EDV, edge, mL", {"readings", "edge", "edv_ml"}, 1},
      {"ESV, edge, mL", {"readings", "edge", "esv_ml"}, 1},
      {"EF, Gaussian profile, %", {"readings", "gaussian_profile", "ef_percent"}, 1},
      {"Muscle, g", {"measures", "muscle_g"}, 0},
      {"Peak filling rate, EDV/s", {"measures", "function", "peak_filling_edv_per_s"}, 2},
      {"Phase SD of the counts, deg", {"measures", "phase", "counts", "sd_deg"}, 1},
      {"Phase SD of the motion, deg", {"measures", "phase", "motion", "sd_deg"}, 1},
  };
  std::string html;
  for (const auto& [name, key] :
       {std::pair("EF, PSF-corrected, %", "ef_percent"), std::pair("EDV, PSF-corrected, mL", "edv_ml"),
        std::pair("ESV, PSF-corrected, mL", "esv_ml")}) {
    const auto a = number_at(rest, {"readings", "psf_corrected", key}),
               b = number_at(stress, {"readings", "psf_corrected", key});
    if (!a && !b) continue;
    html += row(name, {with_interval(rest, key), with_interval(stress, key),
                       figure(a && b ? std::optional(*b - *a) : std::nullopt, 1)});
  }
  for (const Named& line : lines) {
    const auto a = number_at(rest, line.path), b = number_at(stress, line.path);
    if (!a && !b) continue;
    html += row(line.name, {figure(a, line.decimals), figure(b, line.decimals),
                            figure(a && b ? std::optional(*b - *a) : std::nullopt, line.decimals)});
  }
  return html;
}

/// The periodic fit of a result, if it has one.
std::optional<ventricle::PeriodicCurve> curve_of(const Json& results) {
  const auto mean = number_at(results, {"measures", "function", "mean_ml"});
  if (!mean) return std::nullopt;
  ventricle::PeriodicCurve curve{*mean, numbers_at(results, {"measures", "function", "cosine_ml"}),
                                 numbers_at(results, {"measures", "function", "sine_ml"})};
  return curve.cosine.size() == curve.sine.size() ? std::optional(std::move(curve)) : std::nullopt;
}

std::string curves_svg(const ComparedStudy& rest, const ComparedStudy& stress) {
  constexpr int steps = 128;
  constexpr double width = 640, height = 190;
  double top = 1;
  std::string lines;
  std::vector<std::pair<ventricle::PeriodicCurve, const char*>> curves;
  for (const auto& [study, look] :
       {std::pair(&rest, "stroke=\"#0072b2\""), std::pair(&stress, "stroke=\"#d55e00\" stroke-dasharray=\"7 4\"")})
    if (const auto curve = curve_of(study->results)) curves.emplace_back(*curve, look);
  for (const auto& [curve, look] : curves)
    for (int n = 0; n <= steps; ++n) top = std::max(top, curve.at(1.0 * n / steps));
  top = 20 * std::ceil(top / 20);  // so that the four lines stand at multiples of 5 mL
  for (const auto& [curve, look] : curves) {
    lines += std::string("<polyline fill=\"none\" stroke-width=\"2\" ") + look + " points=\"";
    for (int n = 0; n <= steps; ++n) {
      const double phase = 1.0 * n / steps;
      lines += text_of(40 + (width - 60) * phase, 1) + "," +
               text_of(height - 24 - (height - 34) * curve.at(phase) / top, 1) + " ";
    }
    lines += "\"/>\n";
  }
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 190\" role=\"img\">\n";
  for (int n = 0; n <= 4; ++n) {
    const double y = height - 24 - (height - 34) * n / 4;
    svg += "<path d=\"M40 " + text_of(y, 1) + "H620\" stroke=\"#dde3ea\"/><text x=\"34\" y=\"" + text_of(y + 4, 1) +
           "\" font-size=\"11\" text-anchor=\"end\">" + text_of(top * n / 4, 0) + "</text>\n";
  }
  svg += "<text x=\"330\" y=\"184\" font-size=\"11\" text-anchor=\"middle\">one beat</text>\n" + lines;
  return svg +
         "<text x=\"520\" y=\"10\" font-size=\"11\" fill=\"#0072b2\" text-anchor=\"end\">rest</text>"
         "<text x=\"528\" y=\"10\" font-size=\"11\" fill=\"#d55e00\">stress (dashed)</text></svg>\n";
}

/// A map of a table as `polar_svg` wants it.
ventricle::Measures measures_of(const PolarTable& polar, const Json& results) {
  ventricle::Measures m;
  m.grid = polar.grid;
  m.area_mm2 = polar.area_mm2;
  m.maps = polar.maps;
  const Json* kind = value_at(results, {"measures", "thickness_is"});
  m.from_edges = kind == nullptr || *kind != "model";
  return m;
}

bool is_blank(const ventricle::PolarValues& map) {
  return std::none_of(map.begin(), map.end(), [](const auto& value) { return value.has_value(); });
}

std::string map_rows(const ComparedStudy& rest, const ComparedStudy& stress) {
  const ventricle::Measures a = measures_of(rest.polar, rest.results), b = measures_of(stress.polar, stress.results);
  std::string html;
  for (const auto& [name, title, reach] : {std::tuple("perfusion_percent", "Perfusion, rest less stress", 40.0),
                                           std::tuple("thickening_percent", "Thickening, rest less stress", 40.0),
                                           std::tuple("motion_mm", "Inward motion, rest less stress", 6.0)}) {
    const auto kind =
        std::find_if(polar_kinds().begin(), polar_kinds().end(),
                     [&, wanted = std::string_view(name)](const PolarKind& k) { return k.name == wanted; });
    const ventricle::PolarValues &at_rest = a.maps.*kind->values, &stressed = b.maps.*kind->values;
    if (is_blank(at_rest) || is_blank(stressed)) continue;
    ventricle::Measures difference = a;
    difference.maps.*kind->values = lost_under_stress(at_rest, stressed);
    PolarKind lost = *kind;
    lost.name = "difference", lost.title = title, lost.low = -reach, lost.high = reach, lost.is_difference = true;
    const auto map_of = [&](const ventricle::Measures& m, const char* study) {
      PolarKind named = *kind;
      const std::string whole = study + std::string(": ") + std::string(kind->title);
      named.title = whole;
      return "<div>" + polar_svg(m, named) + "</div>";
    };
    html += "<div class=\"maps\">" + map_of(a, "Rest") + map_of(b, "Stress") + "<div>" + polar_svg(difference, lost) +
            "</div></div>\n";
  }
  return html;
}

std::string segment_rows(const ComparedStudy& rest, const ComparedStudy& stress, const Json& comparison) {
  // The scores that are compared are those of the 17 segments.
  const ventricle::SegmentModel model = ventricle::SegmentModel::aha17;
  const ventricle::PolarValues a =
      ventricle::segment_means(model, rest.polar.grid, rest.polar.maps.perfusion_percent, rest.polar.area_mm2);
  const ventricle::PolarValues b =
      ventricle::segment_means(model, stress.polar.grid, stress.polar.maps.perfusion_percent, stress.polar.area_mm2);
  std::string html;
  for (std::size_t n = 0; n < a.size(); ++n) {
    const Json& s = comparison.at("segments").at(n);
    html += row(std::to_string(n + 1) + " " + io::detail::xml_text(s.at("name").get<std::string>()),
                {figure(a[n], 0), figure(b[n], 0), figure(number_at(s, {"perfusion_lost_points"}), 0),
                 figure(number_at(s, {"rest_score"}), 0), figure(number_at(s, {"stress_score"}), 0)});
  }
  return html;
}

std::string box(const char* name, const std::string& value) {
  return std::string("<div>") + name + "<b>" + value + "</b></div>\n";
}

std::string link(const char* name, const ComparedStudy& study) {
  const Json& quality = study.results.at("quality");
  const std::string verdict = quality.value("verdict", "");
  std::string html = std::string("<p>") + name + ": verdict " + io::detail::xml_text(verdict);
  if (!study.report.empty()) html += ", <a href=\"" + io::detail::xml_text(study.report) + "\">its report</a>";
  for (const Json& flag : quality.at("flags")) html += "; " + io::detail::xml_text(flag.value("message", ""));
  return html + "</p>\n";
}

}  // namespace

ventricle::PolarValues lost_under_stress(const ventricle::PolarValues& rest, const ventricle::PolarValues& stress) {
  ventricle::PolarValues lost(rest.size());
  for (std::size_t n = 0; n < lost.size() && n < stress.size(); ++n)
    if (rest[n] && stress[n]) lost[n] = *rest[n] - *stress[n];
  return lost;
}

std::string comparison_html(const ComparedStudy& rest, const ComparedStudy& stress, const Json& comparison) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      // The page loads nothing and runs nothing, whatever texts of the results are in it.
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; img-src "
      "data:\">\n"
      "<title>Rest and stress &ndash; Dynasurf</title>\n<style>";
  html += style;
  html +=
      "</style></head>\n<body><section class=\"sheet\"><header><h1>Left ventricle, rest and stress</h1>"
      "<p class=\"use\">Research use only. Not for diagnosis.</p></header>\n";
  html += link("Rest", rest) + link("Stress", stress);
  html += "<div class=\"ratios\">" + box("TID ratio", figure(number_at(comparison, {"tid_ratio"}), 2)) +
          box("EDV, stress / rest", figure(number_at(comparison, {"edv_ratio"}), 2)) +
          box("Summed rest score", figure(number_at(comparison, {"summed_rest_score"}), 0)) +
          box("Summed stress score", figure(number_at(comparison, {"summed_stress_score"}), 0)) +
          box("Summed difference", figure(number_at(comparison, {"summed_difference_score"}), 0)) + "</div>\n";
  html += slices(rest, stress);
  html +=
      "<h2>Numbers</h2><table><thead><tr><th></th><th>Rest</th><th>Stress</th><th>Stress less "
      "rest</th></tr></thead>\n" +
      number_rows(rest.results, stress.results) + "</table>\n";
  html +=
      "<h2>Volume of the cavity, periodic fit, mL</h2><div class=\"curve\">" + curves_svg(rest, stress) + "</div>\n";
  html += "</section>\n";
  html +=
      "<section><h2>Polar maps: rest, stress, and what is lost under stress</h2>"
      "<p>Seen from the apex, anterior wall on top, septum left. Each map lies in the frame of its own heart: apex, "
      "valve plane, long axis and anterior wall register one with the other.</p>\n" +
      map_rows(rest, stress);
  if (rest.polar.perfusion_is != ventricle::Perfusion::none)
    html +=
        "<h2>Segments: perfusion in percent of the bright wall, scores 0 to 4</h2><table><thead><tr><th></th>"
        "<th>Rest</th><th>Stress</th><th>Lost</th><th>Score at rest</th><th>Score under stress</th></tr></thead>\n" +
        segment_rows(rest, stress, comparison) + "</table>";
  return html + "</section></body></html>\n";
}

}  // namespace dynasurf::report
