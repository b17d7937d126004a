#include "dynasurf/report/normals.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/byte_source.hpp"
#include "dynasurf/report/measures.hpp"
#include "dynasurf/report/numbers.hpp"

namespace dynasurf {
namespace {

using report_detail::Json;
using report_detail::number;

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line)
    if (c == ',')
      fields.emplace_back();
    else if (c != '\r')
      fields.back() += c;
  return fields;
}

std::size_t column_of(const std::vector<std::string>& names, const std::string& name,
                      const std::filesystem::path& path) {
  for (std::size_t n = 0; n < names.size(); ++n)
    if (names[n] == name) return n;
  throw InputError(path.string() + ": no column " + name);
}

/// The number of a field; empty is absent.
std::optional<double> value_of(const std::string& field, const std::string& where) {
  if (field.empty()) return std::nullopt;
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value))
    throw InputError(where + ": '" + field + "' is not a number");
  return value;
}

Json parse(const std::filesystem::path& path) {
  Json json = Json::parse(text_of_file(path), nullptr, false);
  if (!json.is_object()) throw InputError(path.string() + " is not a JSON object");
  return json;
}

PolarValues values_in(const Json& json, const char* key, std::size_t size, const std::filesystem::path& path) {
  if (!json.contains(key) || !json[key].is_array() || json[key].size() != size)
    throw InputError(path.string() + ": " + key + " is no list of " + std::to_string(size) + " numbers");
  PolarValues values(size);
  for (std::size_t n = 0; n < size; ++n) {
    const Json& value = json[key][n];
    if (value.is_null()) continue;
    if (!value.is_number()) throw InputError(path.string() + ": " + key + " holds what is no number");
    values[n] = value.get<double>();
  }
  return values;
}

int whole_in(const Json& json, const char* key, const std::filesystem::path& path) {
  if (!json.contains(key) || !json[key].is_number_integer() || json[key].get<long>() < 1 ||
      json[key].get<long>() > 1000)
    throw InputError(path.string() + ": " + key + " is no number from 1 to 1000");
  return json[key].get<int>();
}

Json list_of(const PolarValues& values) {
  Json list = Json::array();
  for (const auto& v : values) list.push_back(number(v));
  return list;
}

/// Of a result's measures, or of a normal map.
Perfusion perfusion_in(const Json& json, const std::filesystem::path& path) {
  if (!json.is_object() || !json.contains("perfusion_is"))
    throw InputError(path.string() + " does not tell what its perfusion is made of (perfusion_is)");
  const Json& word = json["perfusion_is"];
  if (word.is_null()) return Perfusion::none;
  for (const Perfusion kind : {Perfusion::counts, Perfusion::uptake})
    if (word == word_of(kind)) return kind;
  throw InputError(path.string() + ": perfusion_is " + word.dump() + "; expected counts or uptake");
}

}  // namespace

PolarTable read_polar(const std::filesystem::path& result) {
  const std::filesystem::path csv = result / "measures" / "polar.csv", results = result / "results.json";
  std::istringstream text(text_of_file(csv));
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> names = fields_of(line);
  const std::size_t area = column_of(names, "area_mm2", csv);
  column_of(names, "perfusion_percent", csv);  // the one map that must be there
  PolarTable table;
  table.perfusion_is = perfusion_in(parse(results).value("measures", Json()), results);
  for (int number = 2; std::getline(text, line); ++number) {
    const std::string where = csv.string() + ", line " + std::to_string(number);
    const std::vector<std::string> fields = fields_of(line);
    if (fields.size() != names.size())
      throw InputError(where + ": " + std::to_string(fields.size()) + " fields; expected " +
                       std::to_string(names.size()));
    for (const PolarKind& kind : polar_kinds())
      if (const auto at = std::find(names.begin(), names.end(), kind.name); at != names.end())
        (table.maps.*kind.values).push_back(value_of(fields[static_cast<std::size_t>(at - names.begin())], where));
    table.area_mm2.push_back(value_of(fields[area], where).value_or(0));
  }
  if (table.area_mm2.size() != table.grid.size())
    throw InputError(csv.string() + " has " + std::to_string(table.area_mm2.size()) + " samples; expected " +
                     std::to_string(table.grid.size()));
  return table;
}

void require_same_perfusion(Perfusion a, const std::string& name_a, Perfusion b, const std::string& name_b) {
  for (const auto& [kind, name] : {std::pair(a, name_a), std::pair(b, name_b)})
    if (kind == Perfusion::none) throw InputError(name + " has no perfusion");
  if (a != b)
    throw InputError(name_a + " has perfusion from " + std::string(word_of(a)) + ", " + name_b + " from " +
                     std::string(word_of(b)) + "; expected one kind: reconstruct both with the same preset");
}

std::string normals_text(const NormalMap& normal) {
  Json json;
  json["schema"] = "dynasurf.normals/1";
  json["use"] = "Research use only. Not for diagnosis.";
  json["studies"] = normal.studies;
  json["perfusion_is"] = word_of(normal.perfusion_is);
  json["rings"] = normal.grid.rings;
  json["sectors"] = normal.grid.sectors;
  json["mean"] = list_of(normal.mean);
  json["sd"] = list_of(normal.sd);
  return json.dump() + "\n";
}

NormalMap read_normals(const std::filesystem::path& path) {
  const Json json = parse(path);
  if (json.value("schema", "") != "dynasurf.normals/1")
    throw InputError(path.string() + ": no normal map; expected schema dynasurf.normals/1");
  NormalMap normal;
  normal.studies = whole_in(json, "studies", path);
  normal.perfusion_is = perfusion_in(json, path);
  normal.grid = {whole_in(json, "rings", path), whole_in(json, "sectors", path)};
  normal.mean = values_in(json, "mean", normal.grid.size(), path);
  normal.sd = values_in(json, "sd", normal.grid.size(), path);
  for (std::size_t n = 0; n < normal.grid.size(); ++n)
    if (normal.mean[n].has_value() != normal.sd[n].has_value() || (normal.sd[n] && !(*normal.sd[n] > 0)))
      throw InputError(path.string() + ": sample " + std::to_string(n + 1) + " has no positive sd beside its mean");
  return normal;
}

void read_scores(const std::filesystem::path& path, SegmentScores& scores) {
  const Json json = parse(path);
  for (const auto& [segment, score] : json.items()) {
    const std::optional<double> number = value_of(segment, path.string());
    if (!number || *number != std::floor(*number) || std::abs(*number) > 1000 || !score.is_number_integer() ||
        std::abs(score.get<long>()) > 1000)
      throw InputError(path.string() + ": \"" + segment + "\": " + score.dump() +
                       "; expected the number of a segment and its score");
    try {
      set_score(scores, static_cast<int>(*number), score.get<int>());
    } catch (const InputError& error) {
      throw InputError(path.string() + ": " + error.what());
    }
  }
}

}  // namespace dynasurf
