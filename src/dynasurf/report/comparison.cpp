#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/folder_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/report/detail/comparison_page.hpp"

namespace dynasurf::report {
namespace {

using Json = nlohmann::ordered_json;

/// A number of what was checked on reading; absent where it is null.
std::optional<double> value_in(const Json& json, const char* key) {
  const auto at = json.find(key);
  return at != json.end() && at->is_number() ? std::optional(at->get<double>()) : std::nullopt;
}

/// The reading that leads in both studies, so that like is compared with like; else the edge's, which both have.
std::string common_reading(const ComparedStudy& rest, const ComparedStudy& stress) {
  const std::string leading = rest.results.at("reading").get<std::string>();
  return stress.results.at("reading") == leading ? leading : "edge";
}

const Json& reading_of(const Json& results, const std::string& kind) { return results.at("readings").at(kind); }

/// The cavity's mean over the gates: what an ungated study would show.
std::optional<double> mean_cavity(const Json& results, const std::string& kind) {
  double sum = 0;
  int count = 0;
  for (const Json& gate : results.at("gates")) {
    const auto volume = value_in(kind == "edge" ? gate.at("edge") : gate, "endo_ml");
    if (!volume) return std::nullopt;
    sum += *volume, ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

/// Throws InputError unless each of these is there, a number or null.
void check_numbers(const io::JsonNode& object, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (!object.json->contains(key) || io::has(object, key)) io::number_in(object, key);
}

/// Each gate has a volume in the reading that leads and one of the edges.
void check_gates(const io::JsonNode& results) {
  const io::JsonNode gates = io::list_in(results, "gates");
  if (io::size_of(gates) == 0) io::refuse_value(gates, "a gate at least");
  for (std::size_t n = 0; n < io::size_of(gates); ++n) {
    check_numbers(io::object_of(gates, n), {"endo_ml"});
    check_numbers(io::object_in(io::object_of(gates, n), "edge"), {"endo_ml"});
  }
}

/// The numbers of the beat, and the ends of their 90 % intervals, which the page shows.
void check_reading(const io::JsonNode& reading) {
  check_numbers(reading, {"edv_ml", "esv_ml", "ef_percent"});
  for (const char* key : {"edv_ml_90", "esv_ml_90", "ef_percent_90"})
    if (io::has(reading, key) && io::numbers_in(reading, key).size() != 2)
      io::refuse_value(io::list_in(reading, key), "a list of 2");
}

/// The waves of the volume curve, which the page draws.
void check_curve(const io::JsonNode& results) {
  constexpr std::size_t most_waves = 100;
  if (!io::has(results, "measures") || !io::has(io::object_in(results, "measures"), "function")) return;
  const io::JsonNode function = io::object_in(io::object_in(results, "measures"), "function");
  if (!io::has(function, "mean_ml")) return;
  const std::size_t waves = io::numbers_in(function, "cosine_ml").size();
  if (waves > most_waves || io::numbers_in(function, "sine_ml").size() != waves)
    io::refuse_value(io::list_in(function, "sine_ml"),
                     "as many waves as cosine_ml, at most " + std::to_string(most_waves));
}

/// Throws InputError unless all is there that is compared and shown.
void check_results(const io::JsonNode& results) {
  if (io::text_in(results, "schema") != "dynasurf.ventricle/3")
    throw InputError(results.file + ": expected the schema dynasurf.ventricle/3");
  const std::string leading = io::text_in(results, "reading");
  if (leading != "psf_corrected" && leading != "edge")
    throw InputError(results.file + ": reading: expected psf_corrected or edge");
  const io::JsonNode readings = io::object_in(results, "readings");
  check_reading(io::object_in(readings, "edge"));
  check_reading(io::object_in(readings, leading.c_str()));
  check_reading(results);
  check_gates(results);
  check_curve(results);
  const io::JsonNode quality = io::object_in(results, "quality");
  io::text_in(quality, "verdict");
  const io::JsonNode flags = io::list_in(quality, "flags");
  for (std::size_t n = 0; n < io::size_of(flags); ++n) io::text_in(io::object_of(flags, n), "message");
}

std::optional<double> ratio(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b && *b > 0 ? std::optional(*a / *b) : std::nullopt;
}

}  // namespace

ComparedStudy read_compared_study(const std::filesystem::path& folder) {
  const std::filesystem::path path = io::file_inside(folder, "results.json");
  Json json = io::read_json(path);
  check_results(io::root_of(json, path.string()));
  const std::filesystem::path splash = io::file_inside(folder, std::filesystem::path("measures") / "splash.png");
  return {std::move(json), read_polar(folder), "",
          std::filesystem::exists(splash) ? io::text_of_file(splash) : std::string()};
}

ventricle::Measures difference_of(const ComparedStudy& rest, const ComparedStudy& stress) {
  ventricle::Measures m;
  m.grid = rest.polar.grid;
  m.area_mm2 = rest.polar.area_mm2;
  m.maps.perfusion_percent = lost_under_stress(rest.polar.maps.perfusion_percent, stress.polar.maps.perfusion_percent);
  return m;
}

nlohmann::ordered_json comparison_json(const ComparedStudy& rest, const ComparedStudy& stress,
                                       const ventricle::Measures& difference) {
  const auto number = [](const std::optional<double>& v) { return v ? Json(*v) : Json(); };
  const ventricle::SegmentModel model = ventricle::SegmentModel::aha17;
  const auto scores = [&](const ComparedStudy& side) {
    return ventricle::score_segments(model, side.polar.grid, side.polar.maps.perfusion_percent, side.polar.area_mm2,
                                     nullptr);
  };
  const ventricle::SegmentScores at_rest = scores(rest), under_stress = scores(stress);
  const auto sum_of = [](const ventricle::SegmentScores& scored) {
    return scored.most > 0 ? Json(scored.sum) : Json();
  };
  const ventricle::PolarValues lost =
      ventricle::segment_means(model, difference.grid, difference.maps.perfusion_percent, difference.area_mm2);
  const std::string kind = common_reading(rest, stress);
  const Json &a = reading_of(rest.results, kind), &b = reading_of(stress.results, kind);
  Json json = Json::object();
  json["schema"] = "dynasurf.comparison/1";
  json["use"] = "Research use only. Not for diagnosis.";
  json["reading"] = kind;
  json["tid_ratio"] = number(ratio(mean_cavity(stress.results, kind), mean_cavity(rest.results, kind)));
  json["edv_ratio"] = number(ratio(value_in(b, "edv_ml"), value_in(a, "edv_ml")));
  json["esv_ratio"] = number(ratio(value_in(b, "esv_ml"), value_in(a, "esv_ml")));
  json["ef_rest_percent"] = number(value_in(a, "ef_percent"));
  json["ef_stress_percent"] = number(value_in(b, "ef_percent"));
  json["summed_rest_score"] = sum_of(at_rest);
  json["summed_stress_score"] = sum_of(under_stress);
  json["summed_difference_score"] =
      at_rest.most > 0 && under_stress.most > 0 ? Json(under_stress.sum - at_rest.sum) : Json();
  json["segments"] = Json::array();
  for (const ventricle::Segment& s : ventricle::segments_of(model)) {
    const std::size_t n = s.number - 1;
    const auto score = [&](const ventricle::SegmentScores& of) { return of.score[n] ? Json(*of.score[n]) : Json(); };
    json["segments"].push_back({{"number", s.number},
                                {"name", s.name},
                                {"rest_score", score(at_rest)},
                                {"stress_score", score(under_stress)},
                                {"perfusion_lost_points", number(lost[n])}});
  }
  return json;
}

}  // namespace dynasurf::report
