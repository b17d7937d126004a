#include "command_line.hpp"

#include <array>
#include <charconv>

namespace dynasurf::python {
namespace {

using Json = nlohmann::ordered_json;

/// As a person writes it: 12, not 12.0; a list without brackets.
std::string text_of(const Json& value) {
  if (value.is_null()) return "unset";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_array()) {
    std::string list;
    for (const Json& one : value) list.append(list.empty() ? "" : ",").append(text_of(one));
    return list;
  }
  if (!value.is_number_float()) return value.dump();
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value.get<double>()).ptr;
  return {text.data(), end};
}

}  // namespace

std::string first_difference(const Json& from, const Json& to, const std::string& path) {
  if (from.contains("method") && from["method"] != to["method"]) return path + "=" + to["method"].get<std::string>();
  for (const auto& [name, value] : to.items()) {
    const Json& former = from[name];
    if (former == value) continue;
    const std::string inner = join_path(path, name);
    return value.is_object() ? first_difference(former, value, inner) : inner + "=" + text_of(value);
  }
  return {};
}

}  // namespace dynasurf::python
