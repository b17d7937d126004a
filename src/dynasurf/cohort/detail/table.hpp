#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace dynasurf::cohort::detail {

/// A table with a head, as it stands in a file.
struct TextTable {
  struct Row {
    std::vector<std::string> cells;
    std::size_t line = 0;  // of the file, from 1
  };
  std::vector<std::string> head;
  std::vector<Row> rows;
};

// Readers of tables. Lines that are empty are passed over; CR LF counts as LF. Throw InputError "NAME: line 3: WHAT"
// for a row of another length than the head, a column that stands twice, bytes that are no UTF-8 or control characters.
TextTable parse_tsv(std::string_view text, const std::string& name);
TextTable parse_csv(std::string_view text, const std::string& name);
/// Objects, one a line; the columns are the keys in the order they are met.
TextTable parse_json_lines(std::string_view text, const std::string& name);

/// The text with every tab, line break and control character as a blank: what a cell of TSV may hold.
std::string tsv_cell(std::string_view text);
/// The beginning of a UTF-8 text: at most so many bytes, the last character whole.
std::string cut(std::string_view text, std::size_t most);

}  // namespace dynasurf::cohort::detail
