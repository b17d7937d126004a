#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dynasurf::report {

/// A file that was read.
struct InputFile {
  std::string name;  // not path
  std::string sha256;
  std::uint64_t bytes = 0;
};

/// Where a result comes from: enough to repeat it byte for byte.
struct Provenance {
  std::string program_version, commit;
  std::string command;  // command line without paths that name a person
  std::vector<InputFile> inputs;
  std::string options_json;           // resolved options
  std::optional<std::uint64_t> seed;  // of the random numbers; absent when none were drawn
};

/// How long a run took and how much memory it held is all that differs when it is repeated. With `omit` the keys
/// `timings_s` and `memory` (of clouds) are null and the same input and options give the same bytes.
enum class Timings { keep, omit };

}  // namespace dynasurf::report
