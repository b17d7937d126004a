#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/atomic_file.hpp"
#include "dynasurf/io/byte_source.hpp"
#include "dynasurf/report/measures.hpp"
#include "dynasurf/report/normals.hpp"

#include "command.hpp"
#include "console.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Arguments {
  std::string rest, stress, out;
  bool json = false;
};

/// What two studies are compared by.
struct Side {
  std::optional<double> mean_ml, edv_ml, esv_ml, ef_percent;
  PolarTable polar;
};

std::optional<double> value_in(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_number() ? std::optional(json[key].get<double>()) : std::nullopt;
}

/// The cavity's mean over the gates: what an ungated study would show.
std::optional<double> mean_cavity(const Json& results) {
  double sum = 0;
  int count = 0;
  for (const Json& gate : results["gates"]) {
    const auto volume = value_in(gate, "endo_ml");
    if (!volume) return std::nullopt;
    sum += *volume, ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

Side read_side(const fs::path& folder) {
  const fs::path path = folder / "results.json";
  const Json json = Json::parse(text_of_file(path), nullptr, false);
  if (!json.is_object() || !json.contains("gates") || !json["gates"].is_array())
    throw InputError(path.string() + " is no result of dynasurf ventricle");
  return {mean_cavity(json), value_in(json, "edv_ml"), value_in(json, "esv_ml"), value_in(json, "ef_percent"),
          read_polar(folder / "measures" / "polar.csv")};
}

std::optional<double> ratio(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b && *b > 0 ? std::optional(*a / *b) : std::nullopt;
}

/// Rest less stress: positive where uptake is lost under stress. Both maps are laid out by the same frame of the heart.
Measures difference_of(const Side& rest, const Side& stress) {
  Measures m;
  m.grid = rest.polar.grid;
  m.area_mm2 = rest.polar.area_mm2;
  m.maps.perfusion_percent.resize(m.grid.size());
  for (std::size_t n = 0; n < m.grid.size(); ++n)
    if (rest.polar.perfusion_percent[n] && stress.polar.perfusion_percent[n])
      m.maps.perfusion_percent[n] = *rest.polar.perfusion_percent[n] - *stress.polar.perfusion_percent[n];
  return m;
}

Json comparison(const Side& rest, const Side& stress, const Measures& difference) {
  const auto number = [](const std::optional<double>& v) { return v ? Json(*v) : Json(); };
  const SegmentModel model = SegmentModel::aha17;
  const auto scores = [&](const Side& side) {
    return score_segments(model, side.polar.grid, side.polar.perfusion_percent, side.polar.area_mm2, nullptr);
  };
  const SegmentScores at_rest = scores(rest), under_stress = scores(stress);
  const PolarValues lost =
      segment_means(model, difference.grid, difference.maps.perfusion_percent, difference.area_mm2);
  Json json;
  json["schema"] = "dynasurf.comparison/1";
  json["use"] = "Research use only. Not for diagnosis.";
  json["tid_ratio"] = number(ratio(stress.mean_ml, rest.mean_ml));
  json["edv_ratio"] = number(ratio(stress.edv_ml, rest.edv_ml));
  json["esv_ratio"] = number(ratio(stress.esv_ml, rest.esv_ml));
  json["ef_rest_percent"] = number(rest.ef_percent);
  json["ef_stress_percent"] = number(stress.ef_percent);
  json["summed_rest_score"] = at_rest.sum;
  json["summed_stress_score"] = under_stress.sum;
  json["summed_difference_score"] = under_stress.sum - at_rest.sum;
  json["segments"] = Json::array();
  for (const Segment& s : segments_of(model)) {
    const auto n = static_cast<std::size_t>(s.number - 1);
    const auto score = [&](const SegmentScores& of) { return of.score[n] ? Json(*of.score[n]) : Json(); };
    json["segments"].push_back({{"number", s.number},
                                {"name", s.name},
                                {"rest_score", score(at_rest)},
                                {"stress_score", score(under_stress)},
                                {"perfusion_lost_points", number(lost[n])}});
  }
  return json;
}

ExitCode run(const Arguments& a) {
  const Side rest = read_side(a.rest), stress = read_side(a.stress);
  const Measures difference = difference_of(rest, stress);
  const Json json = comparison(rest, stress, difference);
  if (!a.out.empty()) {
    OutputFolder folder(a.out);
    const PolarKind kind{"difference", "Perfusion, rest less stress", "points", &PolarMaps::perfusion_percent, -40, 40};
    write_file(folder.path() / "comparison.json", json.dump(2) + "\n");
    write_file(folder.path() / "polar_difference.svg", polar_svg(difference, kind));
    folder.publish();
  }
  if (a.json) {
    print(json.dump(2) + "\n");
    return done;
  }
  const auto text = [&](const char* key) {
    return json[key].is_number_float() ? fixed(json[key].get<double>(), 2)
           : json[key].is_null()       ? "-"
                                       : json[key].dump();
  };
  print(
      table({{"TID ratio", text("tid_ratio")},
             {"EDV stress / rest", text("edv_ratio")},
             {"ESV stress / rest", text("esv_ratio")},
             {"EF rest, %", text("ef_rest_percent")},
             {"EF stress, %", text("ef_stress_percent")},
             {"summed scores rest, stress, difference",
              text("summed_rest_score") + ", " + text("summed_stress_score") + ", " + text("summed_difference_score")}},
            {0}) +
      "Research use only. Not for diagnosis.\n");
  return done;
}

}  // namespace

void add_compare(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand(
      "compare", "Compare a rest and a stress result: TID ratio, volumes, scores, difference of the polar maps");
  command->add_option("REST", a->rest, "folder written by dynasurf ventricle")->required();
  command->add_option("STRESS", a->stress, "the same of the stress study")->required();
  command->add_option("--out", a->out, "folder for comparison.json and polar_difference.svg");
  command->add_flag("--json", a->json, "print JSON instead of the table");
  command->callback([a, &chosen] { chosen = [a](std::stop_token) { return run(*a); }; });
}

}  // namespace dynasurf::app
