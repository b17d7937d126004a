#pragma once
#include <algorithm>
#include <string>

namespace dynasurf {

/// ASCII alone, whatever the user's language: other bytes stay as they are.
inline char small_letter(char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; }
inline std::string small_letters(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), small_letter);
  return text;
}

/// Whether a byte continues a character of UTF-8 (10xxxxxx).
inline bool continues_character(char c) { return (c & 0xc0) == 0x80; }

}  // namespace dynasurf
