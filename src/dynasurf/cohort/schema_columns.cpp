#include "dynasurf/cohort/detail/schema_columns.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_read.hpp"

// The assembler copies the published schemas into the library.
#define DYNASURF_EMBED_SCHEMA(name, file) \
  asm(".section .rodata\n" name           \
      "_begin:\n"                         \
      ".incbin \"" file "\"\n" name       \
      "_end:\n"                           \
      ".previous\n")
DYNASURF_EMBED_SCHEMA("dynasurf_ventricle_schema", DYNASURF_SCHEMAS "/results.schema.json");
DYNASURF_EMBED_SCHEMA("dynasurf_cloud_schema", DYNASURF_SCHEMAS "/cloud-results.schema.json");

extern "C" {
extern const char ventricle_schema_begin[] asm("dynasurf_ventricle_schema_begin");
extern const char ventricle_schema_end[] asm("dynasurf_ventricle_schema_end");
extern const char cloud_schema_begin[] asm("dynasurf_cloud_schema_begin");
extern const char cloud_schema_end[] asm("dynasurf_cloud_schema_end");
}

namespace dynasurf::cohort::detail {
namespace {

/// What a result tells of its run and of its use, which is no measure of the heart or body.
constexpr std::array kept_apart{"schema", "use", "options", "timings_s", "memory"};

Json parse(const char* begin, const char* end, const char* name) { return io::parse_json({begin, end}, name); }

/// A node without references and without "or null"; what the place says of it goes before what the definition says.
Json resolved(const Json& schema, Json node) {
  // References that lead around in a circle end after eight steps.
  for (int n = 0; n < 8; ++n) {
    const std::string said = node.value("description", "");
    if (node.contains("anyOf")) {
      for (const Json& choice : Json(node["anyOf"]))
        if (choice.value("type", Json()) != "null") node = choice;
    } else if (node.contains("$ref")) {
      const std::string name = node["$ref"].get<std::string>();
      const bool is_interval = name == "#/$defs/interval";
      node = schema.at(Json::json_pointer(name.substr(1)));
      if (is_interval) node["interval"] = true;
    } else {
      break;
    }
    if (!said.empty()) node["description"] = said;
  }
  return node;
}

bool has_type(const Json& node, std::string_view type) {
  const auto at = node.find("type");
  if (at == node.end()) return false;
  if (at->is_string()) return *at == type;
  return std::any_of(at->begin(), at->end(), [&](const Json& one) { return one == type; });
}

std::string name_of(const std::vector<std::string>& path) {
  std::string name;
  for (std::string part : path) {
    std::replace_if(
        part.begin(), part.end(), [](char c) { return c == ' ' || c == '-' || c == '.'; }, '_');
    name += (name.empty() ? "" : "_") + part;
  }
  return name;
}

Column column_of(const Json& node, const std::vector<std::string>& path, CellType type) {
  Column column;
  column.name = name_of(path);
  column.unit = unit_in(path.back());
  column.meaning = node.value("description", "");
  column.type = type;
  column.path = path;
  return column;
}

void add_interval(const Json& node, const std::vector<std::string>& path, std::vector<Column>& columns) {
  for (const int end : {0, 1}) {
    Column column = column_of(node, path, CellType::real);
    column.name += end == 0 ? "_low" : "_high";
    column.meaning = (end == 0 ? "low end of " : "high end of ") + column.meaning;
    column.end = end;
    columns.push_back(std::move(column));
  }
}

void walk(const Json& schema, const Json& given, const std::vector<std::string>& path, std::vector<Column>& columns) {
  const Json node = resolved(schema, given);
  if (node.contains("interval")) {
    add_interval(node, path, columns);
  } else if (node.contains("properties")) {
    for (const auto& [key, property] : node["properties"].items()) {
      if (std::find(kept_apart.begin(), kept_apart.end(), key) != kept_apart.end()) continue;
      std::vector<std::string> inner = path;
      inner.push_back(key);
      walk(schema, property, inner, columns);
    }
  } else if (has_type(node, "number")) {
    columns.push_back(column_of(node, path, CellType::real));
  } else if (has_type(node, "integer") || has_type(node, "boolean")) {
    columns.push_back(column_of(node, path, CellType::whole));
  } else if (has_type(node, "string") || node.contains("enum") || node.contains("const")) {
    columns.push_back(column_of(node, path, CellType::text));
  }
}

}  // namespace

const Json& schema_of(const std::string& name) {
  static const Json ventricle = parse(ventricle_schema_begin, ventricle_schema_end, "results.schema.json");
  static const Json cloud = parse(cloud_schema_begin, cloud_schema_end, "cloud-results.schema.json");
  for (const Json* schema : {&ventricle, &cloud})
    if (schema->at("title") == name) return *schema;
  throw InputError("results have the schema " + name + "; expected " + ventricle.at("title").get<std::string>() +
                   " or " + cloud.at("title").get<std::string>());
}

std::vector<Column> scalar_columns(const Json& schema, const Json& node) {
  std::vector<Column> columns;
  walk(schema, node, {}, columns);
  return columns;
}

std::vector<Column> item_columns(const Json& schema, const std::vector<std::string>& path) {
  Json node = schema;
  for (const std::string& key : path) {
    node = resolved(schema, node);
    const auto properties = node.find("properties");
    if (properties == node.end() || !properties->contains(key)) return {};
    node = Json(properties->at(key));
  }
  node = resolved(schema, node);
  return node.contains("items") ? scalar_columns(schema, node["items"]) : std::vector<Column>();
}

const Json* value_at(const Json& object, const std::vector<std::string>& path) {
  const Json* at = &object;
  for (const std::string& key : path) {
    if (!at->is_object()) return nullptr;
    const auto found = at->find(key);
    if (found == at->end()) return nullptr;
    at = &*found;
  }
  return at;
}

std::string cell_in(const Json& object, const Column& column) {
  const Json* value = value_at(object, column.path);
  if (value && column.end >= 0) value = value->is_array() && value->size() == 2 ? &(*value)[column.end] : nullptr;
  if (!value || value->is_null() || value->is_structured()) return "";
  if (value->is_boolean()) return value->get<bool>() ? "1" : "0";
  return value->is_string() ? value->get<std::string>() : value->dump();
}

std::string unit_in(const std::string& name) {
  // The first ending that fits counts: _per_s stands before _s.
  constexpr std::array<std::array<std::string_view, 2>, 16> units{{{"_per_s", "EDV/s"},
                                                                   {"_per_beat", "EDV/beat"},
                                                                   {"_ml", "mL"},
                                                                   {"_mm3", "mm3"},
                                                                   {"_mm2", "mm2"},
                                                                   {"_mm", "mm"},
                                                                   {"_ms", "ms"},
                                                                   {"_percent", "%"},
                                                                   {"_deg", "deg"},
                                                                   {"_g", "g"},
                                                                   {"_s", "s"},
                                                                   {"_mb", "MB"},
                                                                   {"_years", "years"},
                                                                   {"_bpm", "1/min"},
                                                                   {"_kev", "keV"},
                                                                   {"_px", "px"}}};
  const std::string stem = name.ends_with("_90") ? name.substr(0, name.size() - 3) : name;
  for (const auto& [ending, unit] : units)
    if (stem.ends_with(ending)) return std::string(unit);
  return "";
}

}  // namespace dynasurf::cohort::detail
