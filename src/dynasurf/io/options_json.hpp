#pragma once
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "dynasurf/core/option_tree.hpp"

namespace dynasurf::io {

// Options as JSON. A group is an object; a method of a family is an object with "method": name beside its options; an
// enumerator is its word; an unset optional number is null. Keys stand in the order of `describe`.
// The text functions do not need nlohmann's full header in the caller.

/// The values of all options as a JSON object.
nlohmann::ordered_json options_to_json(const OptionNodes& nodes);
/// The same as text, indented by two spaces, with a line break at the end.
std::string options_to_text(const OptionNodes& nodes);

/// Assigns what the object names and leaves the rest. Strict: an unknown key, a wrong type, an unknown word, a value
/// out of range or a key that stands twice (text only) throws OptionError with the full path, starting with `path`,
/// and the choices. A family may be given as the word alone ("edges": "canny"); an object without "method" speaks to
/// the method that is current.
void options_from_json(const nlohmann::ordered_json& json, const OptionNodes& nodes, const std::string& path);
void options_from_text(std::string_view text, const OptionNodes& nodes, const std::string& path);

/// The same of a whole options struct.
template <Described O>
std::string options_to_text(O options) {
  return options_to_text(nodes_of(options));
}

/// `options` is unchanged when this throws.
template <Described O>
void options_from_json(const nlohmann::ordered_json& json, O& options, const std::string& path = "") {
  O changed = options;
  options_from_json(json, nodes_of(changed), path);
  options = std::move(changed);
}

/// The same from text; text that is no JSON throws OptionError with line and column.
template <Described O>
void options_from_text(std::string_view text, O& options, const std::string& path = "") {
  O changed = options;
  options_from_text(text, nodes_of(changed), path);
  options = std::move(changed);
}

}  // namespace dynasurf::io
