#pragma once
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

// The columns of the tables of a cohort follow from the published schemas of results: every scalar has one, with what
// the schema says of it, whether a study has a value or not.
namespace dynasurf::cohort::detail {

using Json = nlohmann::ordered_json;

enum class CellType { text, real, whole };

struct Column {
  std::string name, unit, meaning;
  CellType type = CellType::text;
  std::vector<std::string> path;  // from the object that the table is made of
  int end = -1;                   // 0 or 1: low or high end of an interval; else the value itself
};

/// The schema of results with this name ("dynasurf.ventricle/3"). Throws InputError for one that is not known.
const Json& schema_of(const std::string& name);

/// The scalars of an object of the schema, but for what is kept apart: options, times, the use. Lists are passed over,
/// intervals have a column for each end.
std::vector<Column> scalar_columns(const Json& schema, const Json& node);

/// The scalars of the items of a list, found by its path from the root; none where the schema has no such list.
std::vector<Column> item_columns(const Json& schema, const std::vector<std::string>& path);

/// The value of a column in an object as a cell: empty for null or absent, numbers in the C locale.
std::string cell_in(const Json& object, const Column& column);

/// What is found along a path of keys; null where there is nothing.
const Json* value_at(const Json& object, const std::vector<std::string>& path);

/// "mL" for edv_ml, "mm" for radius_mm, ...; empty where the name tells none.
std::string unit_in(const std::string& name);

}  // namespace dynasurf::cohort::detail
