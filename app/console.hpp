#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/progress.hpp"

namespace dynasurf::app {

/// Keeps the first three file descriptors taken, so that no result file can become "standard output" when the caller
/// closed it, and keeps memory (which holds a patient's images) out of core files. Call it first.
void prepare_process();

/// Writes to standard output at once, as `printable` text: names of files must not steer a terminal. Throws IoError
/// when it does not arrive (closed pipe, disk full).
void print(std::string_view text);

/// The one line on standard error that every failure ends with, as `printable` text.
void print_error(std::string_view message);

/// A line on standard error that tells how far something is: written over what stands in it on a terminal, plain
/// elsewhere.
void print_live(std::string_view text, bool terminal);

/// Rows of cells as aligned columns; the first row is the head. `left` names the columns that are aligned left.
std::string table(const std::vector<std::vector<std::string>>& rows, const std::vector<std::size_t>& left = {});

/// A number with fixed decimals; an absent or infinite one is "-".
std::string fixed(double value, int decimals);

std::string line_of(const Note& note);

/// Tells stages on standard error: one line that is written over on a terminal, plain lines elsewhere, nothing when
/// quiet.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void operator()(std::string_view stage, int done, int total);
  /// Ends the live line, so that other text can follow.
  void finish();

 private:
  bool quiet_, terminal_, open_ = false;
};

}  // namespace dynasurf::app
