#include "utf8.hpp"

#include <cstddef>
#include <cstdio>

namespace dynasurf::app {
namespace {

struct Character {
  std::size_t bytes = 0;  // 0: no character begins here
  char32_t code = 0;
};

/// The character at the beginning of a text that is not empty (RFC 3629: shortest form, no surrogates).
Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[n]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {1, lead};
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
  char32_t code = lead & (0xFFu >> (bytes + 1));
  for (std::size_t n = 1; n < bytes; ++n) {
    if ((byte(n) & 0xC0u) != 0x80) return {};
    code = code << 6 | (byte(n) & 0x3Fu);
  }
  constexpr char32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < smallest[bytes] || code > 0x10FFFF || is_surrogate) return {};
  return {bytes, code};
}

bool is_control(char32_t code) {
  return (code < 0x20 && code != '\n' && code != '\t') || (code >= 0x7F && code < 0xA0) || code == 0x2028 ||
         code == 0x2029;
}

/// Marks, embeddings, overrides and isolates of bidirectional text (UAX #9).
bool turns_direction(char32_t code) {
  return code == 0x061C || code == 0x200E || code == 0x200F || (code >= 0x202A && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

template <class IsHidden>
std::string escaped(std::string_view text, const IsHidden& is_hidden) {
  std::string result;
  result.reserve(text.size());
  char buffer[8];
  while (!text.empty()) {
    const Character character = first_of(text);
    if (character.bytes == 0) {
      std::snprintf(buffer, sizeof buffer, "\\x%02x", static_cast<unsigned char>(text[0]));
      result += buffer;
      text.remove_prefix(1);
      continue;
    }
    if (is_hidden(character.code)) {
      std::snprintf(buffer, sizeof buffer, "\\u%04x", character.code & 0xFFFFu);
      result += buffer;
    } else {
      result += text.substr(0, character.bytes);
    }
    text.remove_prefix(character.bytes);
  }
  return result;
}

}  // namespace

std::string valid_utf8(std::string_view text) {
  return escaped(text, [](char32_t) { return false; });
}

std::string printable(std::string_view text) {
  return escaped(text, [](char32_t code) { return is_control(code) || turns_direction(code); });
}

std::string address_of(std::string_view path) {
  constexpr char digits[] = "0123456789ABCDEF";
  constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789/-_.~";
  std::string address;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (plain.find(c) != std::string_view::npos)
      address += c;
    else
      (address += '%') += digits[byte >> 4], address += digits[byte & 15u];
  }
  return address;
}

}  // namespace dynasurf::app
