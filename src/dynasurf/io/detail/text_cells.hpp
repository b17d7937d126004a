#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/detail/letters.hpp"
#include "dynasurf/io/detail/text_reader.hpp"

// Rows of cells in text files: what clouds and tables of points share.
namespace dynasurf::io::detail {

/// The cells of a line.
class Cells {
 public:
  /// A blank as separator stands for any blanks.
  Cells(std::string_view line, char separator) : rest_(line), separator_(separator) {}

  /// The next cell without the blanks around it; nothing at the end of the line.
  std::optional<std::string_view> next() {
    if (done_) return {};
    if (separator_ == ' ') {
      trim_front();
      if (rest_.empty()) return {};
    }
    std::size_t end = 0;
    while (end < rest_.size() && !(separator_ == ' ' ? is_blank(rest_[end]) : rest_[end] == separator_)) ++end;
    std::string_view cell = rest_.substr(0, end);
    done_ = end == rest_.size();
    rest_.remove_prefix(done_ ? end : end + 1);
    while (!cell.empty() && is_blank(cell.front())) cell.remove_prefix(1);
    while (!cell.empty() && is_blank(cell.back())) cell.remove_suffix(1);
    return cell;
  }

 private:
  void trim_front() {
    while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
  }
  std::string_view rest_;
  char separator_;
  bool done_ = false;
};

inline std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::size_t count = 0;  // first, since a hostile line holds millions of cells
  for (Cells cells(line, separator); cells.next();) ++count;
  std::vector<std::string_view> found;
  found.reserve(count);
  for (Cells cells(line, separator); const auto cell = cells.next();) found.push_back(*cell);
  return found;
}

inline char separator_of(std::string_view line) {
  for (const char c : {';', ','})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

/// Next line that is neither empty nor a comment. A line that begins with # or // is one.
inline bool next_row(TextReader& text) {
  while (text.next_line_with_words()) {
    std::string_view line = text.rest();
    while (is_blank(line.front())) line.remove_prefix(1);
    if (line.front() != '#' && !line.starts_with("//")) return true;
  }
  return false;
}

/// The name of a column as it is compared: in small letters, without quotes.
inline std::string column_name(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (c != '"' && c != '\'') out += small_letter(c);
  return out;
}

}  // namespace dynasurf::io::detail
