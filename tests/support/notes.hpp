#pragma once
#include <algorithm>
#include <string>

#include "dynasurf/core/note.hpp"

namespace dynasurf::test {

inline bool has_code(const Notes& notes, const std::string& code) {
  return std::any_of(notes.begin(), notes.end(), [&](const Note& n) { return n.code == code; });
}

}  // namespace dynasurf::test
