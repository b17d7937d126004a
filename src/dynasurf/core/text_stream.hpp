#pragma once
#include <sstream>
#include <string>

namespace dynasurf {

/// The string stream of the library swallows std::bad_alloc: it sets a flag that nobody asks for, and the text ends
/// there. This one passes it on, so that no half of a text is ever published.
struct TextOutput : std::ostringstream {
  TextOutput() { exceptions(std::ios::badbit); }
};

/// The same for a text that is read: a line that found no memory is not taken for the end.
struct TextInput : std::istringstream {
  explicit TextInput(std::string text) : std::istringstream(std::move(text)) { exceptions(std::ios::badbit); }
};

}  // namespace dynasurf
