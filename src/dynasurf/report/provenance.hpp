#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dynasurf {

/// Where a result comes from: enough to repeat it byte for byte.
struct Provenance {
  std::string program_version, commit;
  std::string command;                                      // command line without paths that name a person
  std::vector<std::pair<std::string, std::string>> inputs;  // file name (not path), SHA-256
  std::string options_json;                                 // resolved options
  std::optional<std::uint64_t> seed;                        // of the random numbers; absent when none were drawn
};

/// How long a run took and how much memory it held is all that differs when it is repeated. With `omit` the keys
/// `timings_s` and `memory` (of clouds) are null and the same input and options give the same bytes.
enum class Timings { keep, omit };

}  // namespace dynasurf
