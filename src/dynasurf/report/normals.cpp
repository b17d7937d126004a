#include "dynasurf/report/normals.hpp"

#include <algorithm>
#include <charconv>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/folder_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/report/detail/normals_json.hpp"
#include "dynasurf/report/detail/numbers.hpp"
#include "dynasurf/report/measures.hpp"

namespace dynasurf::report {
namespace {

using detail::Json;
using detail::number;

/// More than any table of ours has; a line of commas alone must not cost a thousand times its size.
constexpr int most_columns = 64;

std::vector<std::string> fields_of(const std::string& line, const std::string& where) {
  if (std::count(line.begin(), line.end(), ',') >= most_columns)
    throw InputError(where + ": expected at most " + std::to_string(most_columns) + " columns");
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
    throw InputError(where + ": " + io::detail::quoted(field) + " is not a number");
  return value;
}

/// One number, or null, for each sample of the grid.
ventricle::PolarValues values_in(const io::JsonNode& object, const char* key, std::size_t size) {
  const io::JsonNode list = io::list_in(object, key);
  if (io::size_of(list) != size) io::refuse_value(list, "a list of " + std::to_string(size));
  ventricle::PolarValues values(size);
  for (std::size_t n = 0; n < size; ++n)
    if (const io::JsonNode value = io::item_of(list, n); !value.json->is_null()) values[n] = io::number_of(value);
  return values;
}

Json list_of(const ventricle::PolarValues& values) {
  Json list = Json::array();
  for (const auto& v : values) list.push_back(number(v));
  return list;
}

/// Of a result's measures, or of a normal map.
ventricle::Perfusion perfusion_in(const io::JsonNode& object) {
  if (!object.json->contains("perfusion_is"))
    throw InputError(object.file + ": does not tell what its perfusion is made of (perfusion_is)");
  if (!io::has(object, "perfusion_is")) return ventricle::Perfusion::none;
  const std::string word = io::text_in(object, "perfusion_is");
  for (const ventricle::Perfusion kind : {ventricle::Perfusion::counts, ventricle::Perfusion::uptake})
    if (word == word_of(kind)) return kind;
  throw InputError(object.file + ": perfusion_is " + io::detail::quoted(word) + "; expected counts or uptake");
}

ventricle::Perfusion perfusion_of_result(const std::filesystem::path& folder) {
  const std::filesystem::path path = io::file_inside(folder, "results.json");
  const Json json = io::read_json(path);
  return perfusion_in(io::object_in(io::root_of(json, path.string()), "measures"));
}

/// The next line that may stand in a table of so many samples.
bool next_line(TextInput& text, std::string& line, std::size_t samples, const std::filesystem::path& csv) {
  if (!std::getline(text, line)) return false;
  if (samples == ventricle::PolarGrid{}.size())
    throw InputError(csv.string() + ": has more samples than the " + std::to_string(samples) + " expected");
  return true;
}

}  // namespace

PolarTable read_polar(const std::filesystem::path& result) {
  const std::filesystem::path csv = io::file_inside(result, std::filesystem::path("measures") / "polar.csv");
  if (!std::filesystem::exists(csv) && std::filesystem::exists(result / "results.json"))
    throw InputError(result.string() + ": has no polar map; expected a result with both walls");
  TextInput text(io::text_of_file(csv));
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> names = fields_of(line, csv.string() + ", line 1");
  const std::size_t area = column_of(names, "area_mm2", csv);
  column_of(names, "perfusion_percent", csv);  // the one map that must be there
  PolarTable table;
  table.perfusion_is = perfusion_of_result(result);
  for (int number = 2; next_line(text, line, table.area_mm2.size(), csv); ++number) {
    const std::string where = csv.string() + ", line " + std::to_string(number);
    const std::vector<std::string> fields = fields_of(line, where);
    if (fields.size() != names.size())
      throw InputError(where + ": " + std::to_string(fields.size()) + " fields; expected " +
                       std::to_string(names.size()));
    for (const PolarKind& kind : polar_kinds())
      if (const auto at = std::find(names.begin(), names.end(), kind.name); at != names.end())
        (table.maps.*kind.values).push_back(value_of(fields[at - names.begin()], where));
    table.area_mm2.push_back(value_of(fields[area], where).value_or(0));
  }
  if (table.area_mm2.size() != table.grid.size())
    throw InputError(csv.string() + " has " + std::to_string(table.area_mm2.size()) + " samples; expected " +
                     std::to_string(table.grid.size()));
  return table;
}

void require_same_perfusion(ventricle::Perfusion a, const std::string& name_a, ventricle::Perfusion b,
                            const std::string& name_b) {
  for (const auto& [kind, name] : {std::pair(a, name_a), std::pair(b, name_b)})
    if (kind == ventricle::Perfusion::none) throw InputError(name + " has no perfusion");
  if (a != b)
    throw InputError(name_a + " has perfusion from " + std::string(word_of(a)) + ", " + name_b + " from " +
                     std::string(word_of(b)) + "; expected one kind: reconstruct both with the same preset");
}

namespace detail {

Json normals_json(const ventricle::NormalMap& normal) {
  Json json = Json::object();
  json["schema"] = "dynasurf.normals/1";
  json["use"] = "Research use only. Not for diagnosis.";
  json["studies"] = normal.studies;
  json["perfusion_is"] = word_of(normal.perfusion_is);
  json["rings"] = normal.grid.rings;
  json["sectors"] = normal.grid.sectors;
  json["mean"] = list_of(normal.mean);
  json["sd"] = list_of(normal.sd);
  return json;
}

ventricle::NormalMap normals_in(const io::JsonNode& map) {
  if (!io::has(map, "schema") || io::text_in(map, "schema") != "dynasurf.normals/1")
    throw InputError(map.file + ": no normal map; expected schema dynasurf.normals/1");
  ventricle::NormalMap normal;
  normal.studies = io::whole_in(map, "studies", 1, 1000000);
  normal.perfusion_is = perfusion_in(map);
  io::whole_in(map, "rings", normal.grid.rings, normal.grid.rings);  // there is one grid
  io::whole_in(map, "sectors", normal.grid.sectors, normal.grid.sectors);
  normal.mean = values_in(map, "mean", normal.grid.size());
  normal.sd = values_in(map, "sd", normal.grid.size());
  for (std::size_t n = 0; n < normal.grid.size(); ++n)
    if (normal.mean[n].has_value() != normal.sd[n].has_value() || (normal.sd[n] && !(*normal.sd[n] > 0)))
      throw InputError(map.file + ": sample " + std::to_string(n + 1) + " has no positive sd beside its mean");
  return normal;
}

}  // namespace detail

std::string normals_text(const ventricle::NormalMap& normal) { return io::json_text(detail::normals_json(normal), -1); }

ventricle::NormalMap read_normals(const std::filesystem::path& path) {
  const Json json = io::read_json(path);
  return detail::normals_in(io::root_of(json, path.string()));
}

void read_scores(const std::filesystem::path& path, ventricle::SegmentScores& scores) {
  const Json json = io::read_json(path);
  io::root_of(json, path.string());  // an object
  for (const auto& [segment, score] : json.items()) {
    const std::optional<double> number = value_of(segment, path.string());
    if (!number || *number != std::floor(*number) || std::abs(*number) > 1000)
      throw InputError(path.string() + ": " + io::detail::quoted(segment) + "; expected the number of a segment");
    const auto value = io::whole_of({&score, path.string(), segment}, 0, 4);
    try {
      ventricle::set_score(scores, *number, value);
    } catch (const InputError& error) {
      throw InputError(path.string() + ": " + error.what());
    }
  }
}

}  // namespace dynasurf::report
