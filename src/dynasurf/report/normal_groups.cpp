#include "dynasurf/report/detail/normal_groups.hpp"

#include <algorithm>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/report/detail/normals_json.hpp"
#include "dynasurf/report/normals.hpp"

namespace dynasurf::report {
namespace {

using detail::Json;

/// "sex=F tracer=MIBI"
std::string name_of_group(const std::vector<std::string>& columns, const std::vector<std::string>& values) {
  std::string name;
  for (std::size_t n = 0; n < columns.size(); ++n) name += (n > 0 ? " " : "") + columns[n] + "=" + values[n];
  return name;
}

std::vector<std::string> texts_in(const io::JsonNode& object, const char* key, std::size_t most) {
  const io::JsonNode list = io::list_in(object, key);
  if (io::size_of(list) > most) io::refuse_value(list, "a list of at most " + std::to_string(most));
  std::vector<std::string> texts;
  for (std::size_t n = 0; n < io::size_of(list); ++n) texts.push_back(io::text_of(io::item_of(list, n)));
  return texts;
}

std::string studies_text(int studies) { return std::to_string(studies) + (studies == 1 ? " study" : " studies"); }

}  // namespace

NormalGroups build_normal_groups(std::vector<GroupedMap> studies, const std::vector<std::string>& columns, int least,
                                 ventricle::Perfusion perfusion_is) {
  // Those of a group side by side; the order of the studies is kept within it.
  std::stable_sort(studies.begin(), studies.end(),
                   [](const GroupedMap& a, const GroupedMap& b) { return a.values < b.values; });
  std::vector<ventricle::PolarValues> maps;
  maps.reserve(studies.size());
  for (GroupedMap& study : studies) maps.push_back(std::move(study.perfusion));
  const auto map_of = [&](std::size_t from, std::size_t count) {
    ventricle::NormalMap map =
        ventricle::build_normal_map(std::span(maps).subspan(from, count), ventricle::PolarGrid{});
    map.perfusion_is = perfusion_is;
    return map;
  };
  NormalGroups normals;
  normals.columns = columns, normals.least = least;
  normals.all = map_of(0, maps.size());
  for (std::size_t from = 0, to = 0; !columns.empty() && from < studies.size(); from = to) {
    const std::vector<std::string>& values = studies[from].values;
    while (to < studies.size() && studies[to].values == values) ++to;
    // Where a column is not known the study stands in no group, but among all.
    if (std::find(values.begin(), values.end(), "") != values.end()) continue;
    const int count = to - from;
    NormalGroups::Group group{values, count, std::nullopt};
    if (count >= least) group.map = map_of(from, count);
    normals.groups.push_back(std::move(group));
  }
  return normals;
}

std::string normal_groups_text(const NormalGroups& normals) {
  Json json = Json::object();
  json["schema"] = "dynasurf.normal_groups/1";
  json["use"] = "Research use only. Not for diagnosis.";
  json["columns"] = normals.columns;
  json["least"] = normals.least;
  json["all"] = detail::normals_json(normals.all);
  json["groups"] = Json::array();
  for (const NormalGroups::Group& group : normals.groups)
    json["groups"].push_back({{"values", group.values},
                              {"studies", group.studies},
                              {"map", group.map ? detail::normals_json(*group.map) : Json()}});
  return io::json_text(json, -1);
}

NormalGroups read_normal_groups(const std::filesystem::path& path) {
  const Json json = io::read_json(path);
  const io::JsonNode file = io::root_of(json, path.string());
  NormalGroups normals;
  // A plain normal map is read as groups without any.
  if (!io::has(file, "schema") || io::text_in(file, "schema") != "dynasurf.normal_groups/1") {
    normals.all = read_normals(path);
    return normals;
  }
  constexpr std::size_t most_columns = 16;
  normals.columns = texts_in(file, "columns", most_columns);
  normals.least = io::whole_in(file, "least", 3, 1000000);
  normals.all = detail::normals_in(io::object_in(file, "all"));
  const io::JsonNode groups = io::list_in(file, "groups");
  for (std::size_t n = 0; n < io::size_of(groups); ++n) {
    const io::JsonNode one = io::object_of(groups, n);
    NormalGroups::Group group;
    group.values = texts_in(one, "values", most_columns);
    if (group.values.size() != normals.columns.size())
      io::refuse_value(io::list_in(one, "values"), "a list of " + std::to_string(normals.columns.size()));
    group.studies = io::whole_in(one, "studies", 1, 1000000);
    if (io::has(one, "map")) group.map = detail::normals_in(io::object_in(one, "map"));
    normals.groups.push_back(std::move(group));
  }
  return normals;
}

ChosenNormals normals_for(const NormalGroups& normals, const std::vector<std::pair<std::string, std::string>>& wanted,
                          const std::string& name) {
  if (wanted.empty()) return {&normals.all, studies_text(normals.all.studies)};
  std::vector<std::string> values(normals.columns.size());
  for (const auto& [column, value] : wanted) {
    const auto at = std::find(normals.columns.begin(), normals.columns.end(), column);
    if (at == normals.columns.end()) throw InputError(name + ": has no groups by " + column);
    values[at - normals.columns.begin()] = value;
  }
  for (std::size_t n = 0; n < values.size(); ++n)
    if (values[n].empty()) throw InputError(name + ": has groups by " + normals.columns[n] + " too; expected a value");
  const auto group = std::find_if(normals.groups.begin(), normals.groups.end(),
                                  [&](const NormalGroups::Group& one) { return one.values == values; });
  const std::string wanted_name = name_of_group(normals.columns, values);
  if (group == normals.groups.end()) {
    std::string known;
    for (const NormalGroups::Group& one : normals.groups)
      known += (known.empty() ? "" : "; ") + name_of_group(normals.columns, one.values);
    throw InputError(name + ": has no group " + wanted_name + "; expected one of: " + known);
  }
  if (group->map) return {&*group->map, studies_text(group->studies) + " of " + wanted_name};
  return {&normals.all, "all " + studies_text(normals.all.studies) + ", for there are only " +
                            std::to_string(group->studies) + " of " + wanted_name};
}

}  // namespace dynasurf::report
