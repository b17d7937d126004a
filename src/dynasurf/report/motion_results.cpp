#include "dynasurf/report/detail/motion_results.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/report/detail/json_parts.hpp"

namespace dynasurf::report {
namespace {

using detail::Json;
using detail::number;
using detail::text_of;
using detail::vector_json;

void put(Json& json, const ventricle::Strains& s) {
  json["radial_percent"] = number(s.radial_percent);
  json["circumferential_percent"] = number(s.circumferential_percent);
  json["longitudinal_percent"] = number(s.longitudinal_percent);
}

Json gate_json(const MotionRun& run, std::size_t g) {
  const ventricle::GateMotion& gate = run.motion.gates[g];
  Json json = Json::object();
  json["gate"] = g + 1;
  json["twist_deg"] = number(gate.twist_deg);
  const double reach = 1.645 * gate.twist_sd_deg;  // 90 % of a normal distribution
  json["twist_deg_90"] = {number(gate.twist_deg - reach), number(gate.twist_deg + reach)};
  json["torsion_deg_per_cm"] = number(gate.torsion_deg_per_cm);
  put(json, gate.strains);
  json["levels"] = Json::array();
  for (std::size_t n = 0; n < gate.levels.size(); ++n) {
    if (!gate.levels[n]) continue;
    const ventricle::LevelMotion& level = *gate.levels[n];
    Json of = Json::object();
    of["level"] = ventricle::names_of(ventricle::WallLevel{})[n];
    of["points"] = level.points;
    of["height_mm"] = number(level.height_mm);
    of["rotation_deg"] = number(level.rotation_deg);
    put(of, level.strains);
    json["levels"].push_back(std::move(of));
  }
  if (!run.cavity_ml.empty()) json["cavity_ml"] = number(run.cavity_ml[g]), json["epi_ml"] = number(run.outer_ml[g]);
  return json;
}

struct Curve {
  std::string name, look;
  std::vector<std::optional<double>> values;
};

/// A step that gives four lines or so.
double even_step(double range) {
  const double unit = own::pow(10, std::floor(own::log10(range / 4)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (range / (factor * unit) <= 5) return factor * unit;
  return 10 * unit;
}

std::string chart(const std::string& title, const std::vector<Curve>& curves, double left) {
  constexpr double width = 330, top = 30, height = 180;
  double low = 0, high = 1;
  for (const Curve& c : curves)
    for (const auto& v : c.values)
      if (v) low = std::min(low, *v), high = std::max(high, *v);
  const double step = even_step(high - low);
  low = step * std::floor(low / step), high = step * std::ceil(high / step);
  const auto y_of = [&](double v) { return text_of(top + height * (high - v) / (high - low), 1); };
  const std::size_t gates = curves[0].values.size();
  const auto x_of = [&](std::size_t g) { return text_of(left + width * g / std::max<std::size_t>(1, gates - 1), 1); };
  std::string svg = "<text class=\"head\" x=\"" + text_of(left, 0) + "\" y=\"14\">" + title + "</text>\n";
  const int lines = round_int((high - low) / step);
  for (int n = 0; n <= lines; ++n) {
    const double v = low + n * step;
    svg += "<path d=\"M" + text_of(left, 0) + " " + y_of(v) + "h" + text_of(width, 0) + "\" stroke=\"" +
           (std::abs(v) < step / 2 ? "#8a94a0" : "#dde3ea") + "\"/><text class=\"end\" x=\"" + text_of(left - 6, 0) +
           "\" y=\"" + y_of(v) + "\" dy=\"4\">" + text_of(std::abs(v) < step / 2 ? 0 : v, step < 1 ? 1 : 0) +
           "</text>\n";
  }
  for (std::size_t g = 0; g < gates; ++g)
    // No more numbers than sixteen fit below the axis.
    if (gates <= 16 || g % ((gates + 15) / 16) == 0)
      svg += "<text class=\"middle\" x=\"" + x_of(g) + "\" y=\"" + text_of(top + height + 16, 0) + "\">" +
             std::to_string(g + 1) + "</text>\n";
  double key = left;
  for (const Curve& c : curves) {
    std::string path;
    bool is_on = false;
    for (std::size_t g = 0; g < gates; ++g) {
      // A gate without a value parts the line.
      if (c.values[g]) path += (is_on ? "L" : "M") + x_of(g) + " " + y_of(*c.values[g]);
      is_on = c.values[g].has_value();
    }
    const std::string y = text_of(top + height + 38, 0);
    svg += "<path d=\"" + path + "\" " + c.look + "/><path d=\"M" + text_of(key, 0) + " " + y + "h18\" " + c.look +
           "/><text x=\"" + text_of(key + 23, 0) + "\" y=\"" + y + "\" dy=\"4\">" + c.name + "</text>\n";
    key += 42 + 6.4 * c.name.size();  // a letter of 12 px is some 6.4 wide
  }
  return svg + "<text class=\"middle\" x=\"" + text_of(left + width / 2, 0) + "\" y=\"" +
         text_of(top + height + 58, 0) + "\">gate</text>\n";
}

template <class F>
std::vector<std::optional<double>> over_gates(const ventricle::TrackedMotion& motion, const F& value_of) {
  std::vector<std::optional<double>> values;
  for (const ventricle::GateMotion& gate : motion.gates) values.push_back(value_of(gate));
  return values;
}

}  // namespace

Json motion_json(const MotionRun& run, const Provenance& provenance) {
  const std::size_t peak = run.motion.peak_gate;
  Json json = Json::object();
  json["schema"] = "dynasurf.motion/1";
  json["use"] = "Research use only. Not for diagnosis.";
  json["points"] = run.points;
  json["spacing_mm"] = number(run.motion.spacing_mm);
  json["rest_gate"] = run.motion.rest_gate + 1;
  json["axis"] = {{"apex_mm", vector_json(run.axis.apex)},
                  {"base_mm", vector_json(run.axis.base)},
                  {"length_mm", number(run.motion.length_mm)}};
  json["peak"] = gate_json(run, peak);
  json["gates"] = Json::array();
  for (std::size_t g = 0; g < run.motion.gates.size(); ++g) json["gates"].push_back(gate_json(run, g));
  json["notes"] = Json::array();
  for (const Note& note : run.notes)
    json["notes"].push_back({{"severity", name_of(note.severity)}, {"code", note.code}, {"message", note.message}});
  json["provenance"] = detail::provenance_json(provenance);
  return json;
}

std::string motion_svg(const ventricle::TrackedMotion& motion) {
  const auto rotation = [&](ventricle::WallLevel level) {
    return over_gates(motion, [&](const ventricle::GateMotion& gate) {
      const auto& of = gate.levels[static_cast<std::size_t>(level)];
      return of ? std::optional(of->rotation_deg) : std::nullopt;
    });
  };
  const auto strain = [&](double ventricle::Strains::*which) {
    return over_gates(motion, [&](const ventricle::GateMotion& gate) { return std::optional(gate.strains.*which); });
  };
  const std::string thin = "fill=\"none\" stroke-width=\"1.6\" stroke=";
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 780 276\" width=\"1170\" height=\"414\" role=\"img\">\n"
      "<style>text{font:12px sans-serif;fill:#333}.head{font-weight:600;fill:#111}.end{text-anchor:end}"
      ".middle{text-anchor:middle}</style>\n<rect width=\"780\" height=\"276\" fill=\"#fff\"/>\n";
  svg += chart("Rotation seen from the apex, degrees, by gate",
               {{"apex", thin + "\"#0072b2\"", rotation(ventricle::WallLevel::apex)},
                {"mid", thin + "\"#009e73\" stroke-dasharray=\"6 3\"", rotation(ventricle::WallLevel::mid)},
                {"base", thin + "\"#d55e00\" stroke-dasharray=\"2 3\"", rotation(ventricle::WallLevel::base)},
                {"twist", "fill=\"none\" stroke-width=\"3\" stroke=\"#111\"",
                 over_gates(motion, [](const ventricle::GateMotion& gate) { return std::optional(gate.twist_deg); })}},
               42);
  svg += chart("Strain, percent, by gate",
               {{"radial", thin + "\"#0072b2\"", strain(&ventricle::Strains::radial_percent)},
                {"circumferential", thin + "\"#009e73\" stroke-dasharray=\"6 3\"",
                 strain(&ventricle::Strains::circumferential_percent)},
                {"longitudinal", thin + "\"#d55e00\" stroke-dasharray=\"2 3\"",
                 strain(&ventricle::Strains::longitudinal_percent)}},
               432);
  return svg + "</svg>\n";
}

}  // namespace dynasurf::report
