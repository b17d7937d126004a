#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace dynasurf::io {

// The one door for JSON: results, options, scores, normal maps and the document of a GLB all come through it, and any
// of them may have been made by somebody who wishes us ill.

/// What is refused before it is looked at, or as soon as it is met. The program's own files stay far below.
inline constexpr std::size_t max_json_bytes = std::size_t{64} << 20;
inline constexpr std::size_t max_json_depth = 64;                       // lists and objects inside each other
inline constexpr std::size_t max_json_values = (std::size_t{1} << 21);  // of all kinds, in the whole text

/// The value of a text of RFC 8259, keys in the order of the text. Strict: one value and white space alone, valid
/// UTF-8, each key once in its object, numbers that a double can hold, no more than the limits above. Time and memory
/// are linear in the text (n log n for the keys of one object), and nothing recurses deeper than the limit. Throws
/// InputError "NAME: line 3, column 1: WHAT; expected WHAT".
nlohmann::ordered_json parse_json(std::string_view text, const std::string& name);

/// The same of a regular file, with its path as the name. Throws IoError too.
nlohmann::ordered_json read_json(const std::filesystem::path& path);

/// JSON as it is written, with a line break at its end. Names of files may hold bytes that are no UTF-8: each is
/// replaced by U+FFFD, because a result must not be lost over a name. `indent` as in nlohmann's `dump`: -1 for one
/// line.
std::string json_text(const nlohmann::ordered_json& json, int indent = 2);

}  // namespace dynasurf::io
