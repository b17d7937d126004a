#pragma once
#include <sstream>
#include <string>

namespace dynasurf {

/// A string stream that throws when memory runs out. std::ostringstream catches std::bad_alloc, sets badbit, and ends
/// the text there, so that half of it could be published.
struct TextOutput : std::ostringstream {
  TextOutput() { exceptions(std::ios::badbit); }
};

/// The same for reading: std::istringstream would end the text at a line that found no memory.
struct TextInput : std::istringstream {
  explicit TextInput(std::string text) : std::istringstream(std::move(text)) { exceptions(std::ios::badbit); }
};

}  // namespace dynasurf
