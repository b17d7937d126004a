#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace dynasurf::io {

// How a value of JSON that was read is looked at: never by `operator[]` of a key that may be absent, which is
// undefined, but by functions that refuse what is not there or not of the kind, and say where: InputError
// "results.json: readings.psf_corrected.edv_ml: missing; expected a number".

/// A value and where it stands. Points into the JSON, which must outlive it.
struct JsonNode {
  const nlohmann::ordered_json* json = nullptr;
  std::string file;
  std::string path;  // "readings.psf_corrected.gates[2]"; empty: the whole
};

/// The whole of a file. Throws InputError unless it is an object.
JsonNode root_of(const nlohmann::ordered_json& json, const std::string& file);

/// "FILE: PATH: VALUE; expected EXPECTED", for a value that a check of the caller refuses.
[[noreturn]] void refuse_value(const JsonNode& node, const std::string& expected);

/// Whether an object has this member, and not as null. False of what is no object.
bool has(const JsonNode& object, std::string_view key);

// The member of an object, of one kind.
JsonNode object_in(const JsonNode& object, std::string_view key);
JsonNode list_in(const JsonNode& object, std::string_view key);
std::string text_in(const JsonNode& object, std::string_view key);
bool flag_in(const JsonNode& object, std::string_view key);
double number_in(const JsonNode& object, std::string_view key);
/// From `low` to `high`, both included.
std::int64_t whole_in(const JsonNode& object, std::string_view key, std::int64_t low, std::int64_t high);
std::vector<double> numbers_in(const JsonNode& object, std::string_view key);

/// Members of a list or an object.
std::size_t size_of(const JsonNode& node);
/// Of a list. Precondition: n < size_of(list).
JsonNode item_of(const JsonNode& list, std::size_t n);
/// Throws unless the item of a list is an object.
JsonNode object_of(const JsonNode& list, std::size_t n);

// A value by itself.
std::string text_of(const JsonNode& node);
double number_of(const JsonNode& node);
std::int64_t whole_of(const JsonNode& node, std::int64_t low, std::int64_t high);

}  // namespace dynasurf::io
