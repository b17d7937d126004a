#include "dynasurf/io/detail/told_counts.hpp"

#include <algorithm>
#include <charconv>

#include "dynasurf/core/detail/letters.hpp"
#include "dynasurf/io/detail/text_cells.hpp"

namespace dynasurf::io::detail {
namespace {

constexpr std::size_t longest_comment = 200;  // that can be a count

/// Words of small letters and numbers; what stands between them only parts them.
std::vector<std::string> words_of(std::string_view comment) {
  std::vector<std::string> words(1);
  for (const char c : comment.substr(0, longest_comment)) {
    const bool parts = is_blank(c) || c == '#' || c == '/' || c == ':' || c == '=' || c == ',';
    if (!parts) words.back() += small_letter(c);
    if (parts && !words.back().empty()) words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::optional<std::size_t> number_in(const std::string& word) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

std::optional<std::size_t>* count_named(ToldCounts& counts, std::string_view word) {
  if (word == "vertices" || word == "points") return &counts.points;
  if (word == "faces" || word == "polygons") return &counts.faces;
  if (word == "rows") return &counts.rows;
  return nullptr;
}

/// The pairs of a name and a number that make up a comment, in either order.
void see(std::string_view comment, ToldCounts& counts) {
  auto words = words_of(comment);
  std::erase_if(words, [](const std::string& w) { return w == "number" || w == "of" || w == "total" || w == "count"; });
  if (words.empty() || words.size() % 2 != 0) return;
  ToldCounts seen = counts;
  for (std::size_t n = 0; n < words.size(); n += 2) {
    const bool number_first = number_in(words[n]).has_value();
    const auto number = number_in(words[number_first ? n : n + 1]);
    auto* count = count_named(seen, words[number_first ? n + 1 : n]);
    if (!number || count == nullptr) return;
    *count = number;
  }
  counts = seen;
}

}  // namespace

ToldCounts told_counts(const MeshFile& file) {
  ToldCounts counts;
  for (TextReader text(file); text.next_line();) {
    if (text.line_is_done()) continue;
    std::string_view line = text.rest();
    while (is_blank(line.front())) line.remove_prefix(1);
    if (line.front() != '#' && !line.starts_with("//")) break;
    see(line, counts);
  }
  return counts;
}

void require_told(const MeshFile& file, const std::optional<std::size_t>& told, std::size_t found, const char* what) {
  if (told && found < *told)
    refuse(file, "", 0,
           "is cut off: holds " + std::to_string(found) + " " + what + "; its first lines tell of " +
               std::to_string(*told));
}

}  // namespace dynasurf::io::detail
