#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "dynasurf/io/detail/mesh_formats.hpp"

namespace dynasurf::io::detail {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

/// Longest line of a text, bytes. The longest that are known hold some thousand cells.
inline constexpr std::size_t longest_line = std::size_t{1} << 20;

/// Walks through a text line by line and word by word and knows where it is. Refuses a line longer than `longest_line`.
/// Refuses a last line without a line break too, since the file may be cut within a number; `may_lack_end` accepts it.
class TextReader {
 public:
  TextReader(const MeshFile& file, std::size_t begin = 0, std::size_t lines_before = 0, bool may_lack_end = false)
      : file_(file), next_(begin), line_number_(lines_before), may_lack_end_(may_lack_end) {}

  /// Goes to the next line; false at the end of the file.
  bool next_line() {
    if (next_ >= file_.bytes.size()) return false;
    ++line_number_;
    const std::string_view line = file_.bytes.substr(next_, longest_line + 1);
    const std::size_t end = line.find('\n');
    if (end == std::string_view::npos && line.size() > longest_line)
      fail("the line is longer than " + std::to_string(longest_line) + " bytes");
    if (end == std::string_view::npos && !may_lack_end_)
      fail("the line has no end; expected a line break after the last line of a whole file");
    rest_ = line.substr(0, end);
    next_ += rest_.size() + 1;
    return true;
  }

  /// The next word of this line; empty when there is none left.
  std::string_view word() {
    std::size_t begin = 0;
    while (begin < rest_.size() && is_blank(rest_[begin])) ++begin;
    std::size_t end = begin;
    while (end < rest_.size() && !is_blank(rest_[end])) ++end;
    const std::string_view found = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return found;
  }

  /// Goes to the next line that holds a word, leaving out what follows `comment`; false at the end of the file.
  bool next_line_with_words(char comment = '\0') {
    while (next_line()) {
      if (comment != '\0') rest_ = rest_.substr(0, rest_.find(comment));
      for (const char c : rest_)
        if (!is_blank(c)) return true;
    }
    return false;
  }

  std::string_view rest() const { return rest_; }
  bool line_is_done() const {
    for (const char c : rest_)
      if (!is_blank(c)) return false;
    return true;
  }

  std::size_t position() const { return next_; }
  std::size_t bytes_left() const { return file_.bytes.size() - std::min(next_, file_.bytes.size()); }
  std::size_t line_number() const { return line_number_; }

  /// The next word as a number; `what` names it in the refusal.
  template <class T>
  T number(std::string_view what) {
    return number_of<T>(word(), what);
  }
  /// A finite coordinate.
  double coordinate(std::string_view what = "a coordinate") {
    const std::string_view text = word();
    const double value = number_of<double>(text, what);
    if (!std::isfinite(value)) fail(std::string(what) + " is " + std::string(text) + "; expected a finite number");
    return value;
  }

  template <class T>
  T number_of(std::string_view text, std::string_view what) const {
    std::string_view digits = text;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (text.empty()) fail("ends before " + std::string(what));
    if (error != std::errc{} || end != digits.data() + digits.size())
      fail(quoted(text) + " stands for " + std::string(what) + "; expected a number");
    return value;
  }

  [[noreturn]] void fail(const std::string& reason) const { refuse(file_, "line", line_number_, reason); }

 private:
  const MeshFile& file_;
  std::size_t next_, line_number_;
  bool may_lack_end_;
  std::string_view rest_;
};

}  // namespace dynasurf::io::detail
