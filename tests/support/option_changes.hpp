#pragma once
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"

namespace dynasurf::test {

/// Values that an option could have besides its own, as text.
inline std::vector<std::string> others_of(const OptionNode& node) {
  const double low = std::max(node.field.min, -100.0), high = std::min(node.field.max, low + 200);
  const auto number = [](double v) { return std::to_string(v); };
  if (const auto* const* v = std::get_if<double*>(&node.ref)) {
    if (**v == 0) return {"0.5", "0.1"};
    return {number(1.1 * **v), number(0.9 * **v)};
  }
  if (const auto* const* v = std::get_if<int*>(&node.ref)) return {std::to_string(**v + 1), std::to_string(**v - 1)};
  if (const auto* const* v = std::get_if<bool*>(&node.ref)) return {**v ? "false" : "true"};
  if (std::holds_alternative<std::string*>(node.ref)) return {"words"};
  if (std::holds_alternative<std::optional<double>*>(node.ref)) return {number(low + 0.1 * (high - low))};
  if (std::holds_alternative<std::optional<int>*>(node.ref)) return {"3"};
  if (std::holds_alternative<std::vector<int>*>(node.ref)) return {"2"};
  if (std::holds_alternative<std::vector<double>*>(node.ref)) return {"1,2,2,0"};
  if (std::holds_alternative<std::optional<std::array<double, 3>>*>(node.ref)) return {"3,2,1"};
  std::vector<std::string> words;
  if (const auto* word = std::get_if<WordRef>(&node.ref)) {
    for (const std::string_view w : word->words) words.emplace_back(w);
    std::rotate(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(word->get()) + 1, words.end());
  } else if (const auto* choice = std::get_if<ChoiceRef>(&node.ref)) {
    for (const std::string_view w : choice->methods) words.emplace_back(w);
    std::rotate(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(choice->current()) + 1, words.end());
  }
  return words;
}

template <Described O>
void collect_changes(const OptionNodes& nodes, const std::string& path, const O& options,
                     std::vector<std::string>& changes) {
  for (const OptionNode& node : nodes) {
    const std::string here = join_path(path, node.name);
    if (const auto* group = std::get_if<GroupRef>(&node.ref)) {
      collect_changes(group->members, here, options, changes);
      continue;
    }
    for (const std::string& other : others_of(node)) {
      O changed = options;
      try {
        set_option(changed, here + '=' + other);
      } catch (const OptionError&) {
        continue;
      }
      changes.push_back(here + '=' + other);
      break;
    }
    if (const auto* choice = std::get_if<ChoiceRef>(&node.ref))
      collect_changes(choice->choose(choice->current()), here, options, changes);
  }
}

/// One change of every option that has an effect with the others as they are, as --set reads it.
template <Described O>
std::vector<std::string> a_change_of_every_option(O options) {
  std::vector<std::string> changes;
  collect_changes(nodes_of(options), "", options, changes);
  return changes;
}

}  // namespace dynasurf::test
