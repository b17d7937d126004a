#pragma once
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/error.hpp"

namespace dynasurf::io {

struct NrrdHeader {
  std::string where;
  std::map<std::string, std::string> fields;  // "field: value", names in lower case without spaces
  std::map<std::string, std::string> keys;    // "key:=value"
  std::uint64_t end = 0;                      // offset of the first byte after the blank line
  bool has_blank_line = false;
  bool data_file_is_last = false;  // of the lines so far

  std::optional<std::string> find(const std::string& name) const {
    const auto it = fields.find(name);
    return it == fields.end() ? std::nullopt : std::optional(it->second);
  }
  std::string need(const std::string& name) const {
    const auto value = find(name);
    if (!value) throw InputError(where + ": NRRD header has no field \"" + name + "\"");
    return *value;
  }
  [[noreturn]] void refuse(const std::string& name, const std::string& expected) const {
    throw InputError(where + ": NRRD field \"" + name + "\" is \"" + find(name).value_or("").substr(0, 80) +
                     "\"; expected " + expected);
  }
};

/// Throws InputError for what is no NRRD header of version 1 to 5, is longer than 1 MiB, or may be cut off.
NrrdHeader read_nrrd_header(const std::filesystem::path& path);

/// A number of a field; throws InputError, naming the field.
template <class T>
T number_of(const NrrdHeader& header, const std::string& field, std::string_view text) {
  T value{};
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || rest != text.data() + text.size()) header.refuse(field, "numbers");
  return value;
}

/// Without blanks at both ends.
std::string trimmed(const std::string& text);
/// The words between blanks.
std::vector<std::string> words(const std::string& text);
/// The entries of a list of quoted words: "mm" "mm" "".
std::vector<std::string> quoted(const std::string& text);

}  // namespace dynasurf::io
