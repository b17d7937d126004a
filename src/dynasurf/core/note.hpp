#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dynasurf {

/// How much a note matters: worth knowing; a reason to look; a reason not to trust the result.
enum class Severity { info, warning, failure };

/// The word for it, as it stands in files.
inline std::string_view name_of(Severity s) {
  return s == Severity::info ? "info" : s == Severity::warning ? "warning" : "failure";
}

/// Something about the *data* that the user must hear of: a hole in a wall, a border that was not found, a step that
/// had to be shortened. Notes travel with results into the terminal, the JSON and the report; they are never dropped.
struct Note {
  Severity severity = Severity::info;
  std::string code;     // stable, lower_case, dotted: "slice_refine.case_3", "gvf.step_limited"
  std::string message;  // one sentence in plain words, with the values
  int gate = -1;        // 0-based, -1: not about one gate
  int slice = -1;       // 0-based in the canonical (apex first) order, -1: not about one slice
  bool operator==(const Note&) const = default;
};

/// All that there is to tell, in the order it came up.
using Notes = std::vector<Note>;

}  // namespace dynasurf
