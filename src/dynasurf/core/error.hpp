#pragma once
#include <cassert>
#include <stdexcept>

namespace dynasurf {

// The caller or the file is wrong. The text names what, where, and what was expected, in one line.

struct InputError : std::runtime_error {  // the content of an input; exit code 2
  using std::runtime_error::runtime_error;
};
struct OptionError : std::runtime_error {  // an option, a parameter, the usage; exit code 1
  using std::runtime_error::runtime_error;
};
struct IoError : std::runtime_error {  // the file system: unreadable, disk full; exit code 2
  using std::runtime_error::runtime_error;
};
struct Cancelled : std::runtime_error {  // the user asked to stop; exit code 3
  using std::runtime_error::runtime_error;
};

/// We are wrong: a broken promise between two functions of the library.
#define DYNASURF_ASSERT(condition) assert(condition)

}  // namespace dynasurf
