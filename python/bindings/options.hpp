#pragma once
#include <string>

#include "dynasurf/io/options_json.hpp"

namespace dynasurf::python {

/// Options from the text that the Python classes make of themselves. Throws OptionError.
template <Described O>
O options_from(const std::string& text) {
  O options;
  if (!text.empty()) io::options_from_text(text, options);
  return options;
}

/// A family by itself, as the one member of a struct.
template <class Family>
struct OneOf {
  Family method{};
};
template <class Family>
void describe(auto& visit, OneOf<Family>& o) {
  visit("method", o.method, OptionInfo{"the method"});
}
template <class Family>
Family family_from(const std::string& text) {
  return options_from<OneOf<Family>>("{\"method\": " + text + "}").method;
}

}  // namespace dynasurf::python
