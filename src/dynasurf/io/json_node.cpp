#include "dynasurf/io/detail/json_node.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_read.hpp"

namespace dynasurf::io {
namespace {

using Json = nlohmann::ordered_json;

std::string path_in(const JsonNode& object, std::string_view key) {
  return object.path + (object.path.empty() ? "" : ".") + std::string(key);
}

std::string shown(const Json& json) {
  if (json.is_object()) return "an object";
  if (json.is_array()) return "a list of " + std::to_string(json.size());
  constexpr std::size_t most = 40;
  const bool is_long = json.is_string() && json.get_ref<const std::string&>().size() > most;
  std::string text = json_text(is_long ? Json(json.get_ref<const std::string&>().substr(0, most) + "...") : json, -1);
  text.pop_back();  // the line break
  return text;
}

JsonNode member(const JsonNode& object, std::string_view key, const std::string& expected) {
  if (!object.json->is_object()) refuse_value(object, "an object");
  const auto at = object.json->find(key);
  if (at == object.json->end())
    throw InputError(object.file + ": " + path_in(object, key) + ": missing; expected " + expected);
  return {&*at, object.file, path_in(object, key)};
}

}  // namespace

JsonNode root_of(const nlohmann::ordered_json& json, const std::string& file) {
  if (!json.is_object()) throw InputError(file + ": holds " + shown(json) + "; expected an object {...}");
  return {&json, file, {}};
}

void refuse_value(const JsonNode& node, const std::string& expected) {
  throw InputError(node.file + ": " + (node.path.empty() ? "" : node.path + ": ") + shown(*node.json) + "; expected " +
                   expected);
}

bool has(const JsonNode& object, std::string_view key) {
  if (!object.json->is_object()) return false;
  const auto at = object.json->find(key);
  return at != object.json->end() && !at->is_null();
}

JsonNode object_in(const JsonNode& object, std::string_view key) {
  JsonNode found = member(object, key, "an object");
  if (!found.json->is_object()) refuse_value(found, "an object");
  return found;
}

JsonNode list_in(const JsonNode& object, std::string_view key) {
  JsonNode found = member(object, key, "a list");
  if (!found.json->is_array()) refuse_value(found, "a list");
  return found;
}

std::string text_in(const JsonNode& object, std::string_view key) { return text_of(member(object, key, "a text")); }

bool flag_in(const JsonNode& object, std::string_view key) {
  const JsonNode found = member(object, key, "true or false");
  if (!found.json->is_boolean()) refuse_value(found, "true or false");
  return found.json->get<bool>();
}

double number_in(const JsonNode& object, std::string_view key) { return number_of(member(object, key, "a number")); }

std::int64_t whole_in(const JsonNode& object, std::string_view key, std::int64_t low, std::int64_t high) {
  return whole_of(member(object, key, "a whole number"), low, high);
}

std::vector<double> numbers_in(const JsonNode& object, std::string_view key) {
  const JsonNode list = list_in(object, key);
  std::vector<double> numbers;
  for (std::size_t n = 0; n < size_of(list); ++n) numbers.push_back(number_of(item_of(list, n)));
  return numbers;
}

std::size_t size_of(const JsonNode& node) { return node.json->size(); }

JsonNode item_of(const JsonNode& list, std::size_t n) {
  DYNASURF_ASSERT(list.json->is_array() && n < list.json->size());
  return {&(*list.json)[n], list.file, list.path + "[" + std::to_string(n) + "]"};
}

JsonNode object_of(const JsonNode& list, std::size_t n) {
  JsonNode item = item_of(list, n);
  if (!item.json->is_object()) refuse_value(item, "an object");
  return item;
}

std::string text_of(const JsonNode& node) {
  if (!node.json->is_string()) refuse_value(node, "a text");
  return node.json->get<std::string>();
}

double number_of(const JsonNode& node) {
  if (!node.json->is_number()) refuse_value(node, "a number");
  return node.json->get<double>();
}

std::int64_t whole_of(const JsonNode& node, std::int64_t low, std::int64_t high) {
  const Json& json = *node.json;
  // nlohmann keeps positive numbers unsigned, and converting one of 2^63 or more to a signed type would wrap around.
  const bool fits =
      json.is_number_unsigned() ? std::in_range<std::int64_t>(json.get<std::uint64_t>()) : json.is_number_integer();
  const std::int64_t value = fits ? json.get<std::int64_t>() : 0;
  if (!fits || value < low || value > high)
    refuse_value(node, "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  return value;
}

}  // namespace dynasurf::io
