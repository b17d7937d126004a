#include "dynasurf/core/option_tree.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>

#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;

template <class Number>
std::string text_of(Number value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

/// Limits are round numbers: 100000 reads better than 1e+05.
std::string limit_text(double limit) {
  const bool whole = limit == std::round(limit) && std::abs(limit) < 1e9;
  return whole ? text_of(static_cast<long long>(limit)) : text_of(limit);
}

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number value{};
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class List>
std::string list_text(const List& numbers) {
  std::string text;
  for (const auto number : numbers) text.append(text.empty() ? "" : ",").append(text_of(number));
  return text;
}

/// "1280,320" or "[1280, 320]"; nothing for anything else.
template <class Number>
std::optional<std::vector<Number>> numbers_in(std::string_view text) {
  // A bracket that stands alone is a slip.
  if (text.starts_with('[') != text.ends_with(']')) return std::nullopt;
  if (text.starts_with('[')) text = text.substr(1, text.size() - 2);
  std::vector<Number> numbers;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    std::string_view word = text.substr(at, comma - at);
    if (const std::size_t first = word.find_first_not_of(' '); first != std::string_view::npos)
      word.remove_prefix(first);
    const auto number = number_in<Number>(word);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    at = comma + 1;
  }
  return numbers;
}

/// Levenshtein's distance: how many letters must change.
std::size_t typing_errors(std::string_view a, std::string_view b) {
  // Of the table of distances one row is kept at a time.
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// The word nearest to `typed`, or nothing when none looks like it.
std::string_view nearest(std::string_view typed, std::span<const std::string_view> words) {
  std::string_view best;
  // Two errors, or one in three letters; a beginning of three letters counts as one error.
  std::size_t least = std::max<std::size_t>(2, typed.size() / 3) + 1;
  for (const std::string_view word : words) {
    const bool cut_short = typed.size() >= 3 && word.starts_with(typed);
    const std::size_t errors = cut_short ? 1 : typing_errors(typed, word);
    if (errors < least && errors < word.size()) {
      least = errors;
      best = word;
    }
  }
  return best;
}

template <class Words>
std::string joined(const Words& words, std::string_view separator) {
  std::string text;
  for (const std::string_view word : words) text.append(text.empty() ? "" : separator).append(word);
  return text;
}

void collect_names(const OptionNodes& nodes, const std::string& path, std::vector<std::string>& paths);

std::string range_of(const OptionInfo& field) {
  const bool low = std::isfinite(field.min);
  const bool high = std::isfinite(field.max);
  if (low && high) return limit_text(field.min) + " to " + limit_text(field.max);
  if (low) return ">= " + limit_text(field.min);
  return high ? "<= " + limit_text(field.max) : "";
}

std::string number_words(std::string noun, const OptionInfo& field) {
  const bool low = std::isfinite(field.min);
  const bool high = std::isfinite(field.max);
  if (low) noun += " >= " + limit_text(field.min);
  if (low && high) noun += " and";
  if (high) noun += " <= " + limit_text(field.max);
  if (!field.unit.empty()) noun += " (" + std::string(field.unit) + ")";
  return noun;
}

/// Names of the leaves below, for messages.
void collect_names(const OptionNodes& nodes, const std::string& path, std::vector<std::string>& paths) {
  for (const OptionNode& node : nodes) {
    const std::string here = join_path(path, node.name);
    if (const auto* group = std::get_if<GroupRef>(&node.ref)) {
      collect_names(group->members, here, paths);
    } else {
      paths.push_back(here);
      if (const auto* choice = std::get_if<ChoiceRef>(&node.ref))
        collect_names(choice->choose(choice->current()), here, paths);
    }
  }
}

void set_below(const OptionNodes& nodes, const std::string& path, std::string_view rest, std::string_view text,
               const ChoiceRef* family);

/// The part of the path that follows `node` is `rest`; empty: the node itself is meant.
void set_in(const OptionNode& node, const std::string& path, std::string_view rest, std::string_view text) {
  if (rest.empty()) return assign_text(node, path, text);
  if (const auto* group = std::get_if<GroupRef>(&node.ref)) return set_below(group->members, path, rest, text, nullptr);
  if (const auto* choice = std::get_if<ChoiceRef>(&node.ref)) {
    if (rest == "method") return assign_text(node, path + ".method", text);
    return set_below(choice->choose(choice->current()), path, rest, text, choice);
  }
  throw OptionError("option " + path + " has no members; it is " + expected_of(node));
}

void set_below(const OptionNodes& nodes, const std::string& path, std::string_view rest, std::string_view text,
               const ChoiceRef* family) {
  const std::size_t dot = rest.find('.');
  const std::string_view name = rest.substr(0, dot);
  const std::string_view below = dot == std::string_view::npos ? "" : rest.substr(dot + 1);
  for (const OptionNode& node : nodes)
    if (node.name == name) return set_in(node, join_path(path, name), below, text);
  throw_unknown_option(nodes, path, name, family != nullptr);
}

/// The current method of the family at a path; empty where none stands.
std::string_view method_at(const OptionNodes& nodes, std::string_view path) {
  const std::size_t dot = path.find('.');
  const bool is_end = dot == std::string_view::npos;
  for (const OptionNode& node : nodes) {
    if (node.name != path.substr(0, dot)) continue;
    const auto* choice = std::get_if<ChoiceRef>(&node.ref);
    if (is_end) return choice ? choice->methods[choice->current()] : "";
    const auto* group = std::get_if<GroupRef>(&node.ref);
    if (group) return method_at(group->members, path.substr(dot + 1));
    return choice ? method_at(choice->choose(choice->current()), path.substr(dot + 1)) : "";
  }
  return {};
}

void add_rows(const OptionNodes& nodes, const std::string& path, const std::string& method,
              std::vector<OptionRow>& rows) {
  for (const OptionNode& node : nodes) {
    const std::string here = join_path(path, node.name);
    if (const auto* group = std::get_if<GroupRef>(&node.ref)) {
      add_rows(group->members, here, method, rows);
      continue;
    }
    OptionRow row{
        here, method, "", std::string(node.field.unit), range_of(node.field), "", std::string(node.field.doc)};
    const auto optional_text = [](const auto& v) { return v ? text_of(*v) : std::string("unset"); };
    std::visit(Overload{[&](const auto* number) { row.default_value = text_of(*number); },
                        [&](const bool* v) {
                          row.default_value = *v ? "true" : "false";
                          row.choices = "false | true";
                        },
                        [&](const std::string* v) { row.default_value = *v; },
                        [&](const std::optional<double>* v) { row.default_value = optional_text(*v); },
                        [&](const std::optional<int>* v) { row.default_value = optional_text(*v); },
                        [&]<class Number>(const std::vector<Number>* v) {
                          row.default_value = v->empty() ? "unset" : list_text(*v);
                        },
                        [&](const std::optional<std::array<double, 3>>* v) {
                          row.default_value = *v ? list_text(**v) : "unset";
                        },
                        [&](const WordRef& word) {
                          row.default_value = word.words[word.get()];
                          row.choices = joined(word.words, " | ");
                        },
                        [&](const ChoiceRef& choice) {
                          row.default_value = choice.methods[choice.current()];
                          row.choices = joined(choice.methods, " | ");
                        },
                        [](const GroupRef&) {}},
               node.ref);
    rows.push_back(std::move(row));
    if (const auto* choice = std::get_if<ChoiceRef>(&node.ref)) {
      // The current method comes first, with its present values; choosing it again at the end would reset them.
      const std::size_t current = choice->current();
      add_rows(choice->choose(current), here, std::string(choice->methods[current]), rows);
      for (std::size_t m = 0; m < choice->methods.size(); ++m)
        if (m != current) add_rows(choice->choose(m), here, std::string(choice->methods[m]), rows);
      if (choice->current() != current) choice->choose(current);
    }
  }
}

}  // namespace

std::string join_path(const std::string& path, std::string_view name) {
  return path.empty() ? std::string(name) : path + "." + std::string(name);
}

bool in_range(const OptionInfo& field, double value) {
  return std::isfinite(value) && value >= field.min && value <= field.max;
}

std::string expected_of(const OptionNode& node) {
  const auto number = [&](std::string noun) { return number_words(std::move(noun), node.field); };
  return std::visit(
      Overload{[&](const double*) { return number("a number"); }, [&](const int*) { return number("a whole number"); },
               [&](const std::uint64_t*) { return std::string("a whole number >= 0"); },
               [](const bool*) { return std::string("true or false"); },
               [](const std::string*) { return std::string("a text"); },
               [&](const std::optional<double>*) { return number("unset or a number"); },
               [&](const std::optional<int>*) { return number("unset or a whole number"); },
               [&](const std::vector<int>*) { return number("a list of whole numbers"); },
               [&](const std::vector<double>*) { return number("a list of numbers"); },
               [&](const std::optional<std::array<double, 3>>*) { return number("unset or a list of three numbers"); },
               [](const WordRef& word) { return "one of " + joined(word.words, ", "); },
               [](const ChoiceRef& choice) { return "one of the methods " + joined(choice.methods, ", "); },
               [](const GroupRef&) { return std::string("a group of options"); }},
      node.ref);
}

void assign_text(const OptionNode& node, const std::string& path, std::string_view text) {
  const auto wrong = [&] { throw_wrong_value(node, path, "'" + std::string(text) + "'"); };
  const auto number = [&]<class Number>(Number& target) {
    const auto value = number_in<Number>(text);
    if (!value || !in_range(node.field, *value)) wrong();
    target = *value;
  };
  const auto list = [&]<class Number>(std::vector<Number>& target) {
    const auto numbers = numbers_in<Number>(text);
    const auto fits = [&](Number value) { return in_range(node.field, value); };
    if (!numbers || !std::all_of(numbers->begin(), numbers->end(), fits)) wrong();
    target = *numbers;
  };
  const auto optional = [&]<class Number>(std::optional<Number>& target) {
    if (text == "unset") {
      target.reset();
      return;
    }
    Number value{};
    number(value);
    target = value;
  };
  std::visit(
      Overload{[&](double* v) { number(*v); }, [&](int* v) { number(*v); }, [&](std::uint64_t* v) { number(*v); },
               [&](bool* v) {
                 if (text != "true" && text != "false") wrong();
                 *v = text == "true";
               },
               [&](std::string* v) { *v = text; }, [&](std::optional<double>* v) { optional(*v); },
               [&](std::optional<int>* v) { optional(*v); },
               [&]<class Number>(std::vector<Number>* v) { text == "unset" ? v->clear() : list(*v); },
               [&](std::optional<std::array<double, 3>>* v) {
                 if (text == "unset") return v->reset();
                 std::vector<double> three;
                 list(three);
                 if (three.size() != 3) wrong();
                 *v = {three[0], three[1], three[2]};
               },
               [&](const WordRef& word) { word.set(position_of(word.words, text, path)); },
               [&](const ChoiceRef& choice) { choice.choose(position_of(choice.methods, text, path)); },
               [&](const GroupRef& group) {
                 std::vector<std::string> members;
                 collect_names(group.members, path, members);
                 throw OptionError("option " + path + " is a group; set one of its members: " + joined(members, ", "));
               }},
      node.ref);
}

void throw_wrong_value(const OptionNode& node, const std::string& path, const std::string& value) {
  throw OptionError("option " + path + " is " + value + "; expected " + expected_of(node));
}

void throw_unknown_option(const OptionNodes& siblings, const std::string& path, std::string_view name, bool in_family) {
  std::vector<std::string_view> names;
  if (in_family) names.emplace_back("method");
  for (const OptionNode& node : siblings) names.push_back(node.name);
  std::string text = "unknown option '" + join_path(path, name) + "'";
  if (const std::string_view near = nearest(name, names); !near.empty()) {
    text += "; did you mean '" + join_path(path, near) + "'?";
  } else {
    // Perhaps the right name in the wrong place.
    std::vector<std::string> leaves;
    collect_names(siblings, path, leaves);
    std::string ending = ".";
    ending += name;
    const auto same =
        std::find_if(leaves.begin(), leaves.end(), [&](const std::string& leaf) { return leaf.ends_with(ending); });
    text += same != leaves.end() ? "; did you mean '" + *same + "'?" : ";";
  }
  throw OptionError(text + " choices: " + (names.empty() ? "none" : joined(names, ", ")));
}

std::size_t position_of(std::span<const std::string_view> words, std::string_view word, const std::string& path) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return found - words.begin();
  std::string text = "option " + path + " is '" + std::string(word) + "'";
  const std::string_view near = nearest(word, words);
  text += near.empty() ? ";" : "; did you mean '" + std::string(near) + "'?";
  throw OptionError(text + " choices: " + joined(words, ", "));
}

void set_option(const OptionNodes& nodes, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  // Dots around the path show empty names at its ends too, as two dots in a row.
  std::string path = ".";
  path += assignment.substr(0, equals);
  path += '.';
  if (equals == std::string_view::npos || path.find("..") != std::string::npos)
    throw OptionError("'" + std::string(assignment) +
                      "' is no setting; expected path=value, for example edges.low=0.2");
  set_below(nodes, "", assignment.substr(0, equals), assignment.substr(equals + 1), nullptr);
}

void set_options(const OptionNodes& nodes, std::span<const std::string> assignments) {
  for (std::size_t n = 0; n < assignments.size(); ++n) {
    std::string path = assignments[n].substr(0, assignments[n].find('='));
    if (path.ends_with(".method")) path.erase(path.rfind('.'));
    const std::string_view former = method_at(nodes, path);
    set_option(nodes, assignments[n]);
    const std::string_view method = method_at(nodes, path);
    if (method == former) continue;
    for (const std::string& before : assignments.first(n)) {
      const std::string lost = before.substr(0, before.find('='));
      if (lost.starts_with(path + ".") && lost != path + ".method")
        throw OptionError("option " + lost + " is set before " + assignments[n] +
                          ", which begins with the defaults of " + std::string(method) + "; set it after that");
    }
  }
}

std::vector<OptionRow> option_table(const OptionNodes& nodes) {
  std::vector<OptionRow> rows;
  add_rows(nodes, "", "", rows);
  return rows;
}

}  // namespace dynasurf
