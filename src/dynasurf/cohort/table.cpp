#include "dynasurf/cohort/detail/table.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "dynasurf/core/detail/letters.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_read.hpp"

namespace dynasurf::cohort::detail {
namespace {

[[noreturn]] void refuse(const std::string& name, std::size_t line, const std::string& what) {
  throw InputError(name + ": line " + std::to_string(line) + ": " + what);
}

bool is_control(unsigned char c) { return c < 32 || c == 127; }

/// Checks and takes in the cells of a line: the first is the head.
void add_row(TextTable& table, TextTable::Row row, const std::string& name) {
  for (const std::string& cell : row.cells)
    if (std::any_of(cell.begin(), cell.end(), is_control))
      refuse(name, row.line, "a cell holds a control character; expected text");
  if (table.head.empty()) {
    std::set<std::string> seen;
    for (const std::string& column : row.cells) {
      if (column.empty()) refuse(name, row.line, "a column has no name; expected names of columns");
      if (!seen.insert(column).second) refuse(name, row.line, "column " + column + " stands twice; expected it once");
    }
    table.head = std::move(row.cells);
    return;
  }
  if (row.cells.size() != table.head.size())
    refuse(name, row.line,
           std::to_string(row.cells.size()) + " cells; expected " + std::to_string(table.head.size()) +
               " as in the first line");
  table.rows.push_back(std::move(row));
}

/// Spreadsheets put a byte order mark before UTF-8, which would become part of the first name.
std::string_view without_mark(std::string_view text) {
  return text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
}

/// Calls `use(line, number)` for each line that is not empty.
template <class Use>
void each_line(std::string_view text, const Use& use) {
  text = without_mark(text);
  for (std::size_t from = 0, number = 1; from < text.size(); ++number) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    std::string_view line = text.substr(from, to - from);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!line.empty()) use(line, number);
    from = to + 1;
  }
}

std::string cell_of(const nlohmann::ordered_json& value, const std::string& name, std::size_t line) {
  if (value.is_null()) return "";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number() || value.is_boolean()) return value.dump();
  refuse(name, line, "a value is a list or an object; expected a text or a number");
}

/// A cell of CSV from `at` on, and the place behind it.
std::string csv_cell(std::string_view text, std::size_t& at, std::size_t line, const std::string& name) {
  std::string cell;
  if (at >= text.size() || text[at] != '"') {
    for (; at < text.size() && text[at] != ',' && text[at] != '\n'; ++at) {
      if (text[at] == '"') refuse(name, line, "a quote within a cell; expected the whole cell in quotes");
      cell += text[at];
    }
    // RFC 4180 ends lines by CR LF; a CR elsewhere is part of the cell, and refused as a control character.
    if (cell.ends_with('\r') && (at == text.size() || text[at] == '\n')) cell.pop_back();
    return cell;
  }
  for (++at; at < text.size(); ++at) {
    if (text[at] != '"') {
      cell += text[at];
    } else if (at + 1 < text.size() && text[at + 1] == '"') {
      cell += text[++at];
    } else {
      ++at;
      if (at < text.size() && text[at] == '\r') ++at;
      if (at < text.size() && text[at] != ',' && text[at] != '\n')
        refuse(name, line, "text behind a closing quote; expected a comma");
      return cell;
    }
  }
  refuse(name, line, "a quote is not closed; expected \" at the end of the cell");
}

}  // namespace

TextTable parse_tsv(std::string_view text, const std::string& name) {
  TextTable table;
  each_line(text, [&](std::string_view line, std::size_t number) {
    TextTable::Row row;
    row.line = number;
    for (std::size_t from = 0; from <= line.size();) {
      const std::size_t to = std::min(line.find('\t', from), line.size());
      row.cells.emplace_back(line.substr(from, to - from));
      from = to + 1;
    }
    add_row(table, std::move(row), name);
  });
  return table;
}

TextTable parse_csv(std::string_view text, const std::string& name) {
  TextTable table;
  text = without_mark(text);
  std::size_t line = 1;
  for (std::size_t at = 0; at < text.size();) {
    TextTable::Row row;
    row.line = line;
    while (true) {
      row.cells.push_back(csv_cell(text, at, line, name));
      line += std::count(row.cells.back().begin(), row.cells.back().end(), '\n');
      if (at >= text.size() || text[at] == '\n') break;
      ++at;
    }
    ++at;
    ++line;
    if (row.cells.size() > 1 || !row.cells.front().empty()) add_row(table, std::move(row), name);
  }
  return table;
}

TextTable parse_json_lines(std::string_view text, const std::string& name) {
  TextTable table;
  std::map<std::string, std::size_t> columns;
  each_line(text, [&](std::string_view line, std::size_t number) {
    const nlohmann::ordered_json object = io::parse_json(line, name + ": line " + std::to_string(number));
    if (!object.is_object()) refuse(name, number, "is no object; expected {\"path\": ...}");
    TextTable::Row row;
    row.line = number;
    for (const auto& [key, value] : object.items()) {
      const auto [at, is_new] = columns.emplace(key, table.head.size());
      if (is_new) table.head.push_back(key);
      // A key may come first in a later object: rows before it are filled up at the end.
      row.cells.resize(std::max(row.cells.size(), table.head.size()));
      row.cells[at->second] = cell_of(value, name, number);
    }
    for (const std::string& cell : row.cells)
      if (std::any_of(cell.begin(), cell.end(), is_control))
        refuse(name, number, "a value holds a control character; expected text");
    table.rows.push_back(std::move(row));
  });
  for (TextTable::Row& row : table.rows) row.cells.resize(table.head.size());
  return table;
}

std::string tsv_cell(std::string_view text) {
  std::string cell(text);
  std::replace_if(cell.begin(), cell.end(), is_control, ' ');
  return cell;
}

std::string cut(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  while (most > 0 && continues_character(text[most])) --most;
  return std::string(text.substr(0, most));
}

}  // namespace dynasurf::cohort::detail
