#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "dynasurf/core/option_tree.hpp"

namespace dynasurf {

/// The first of a program's stages that the options with this beginning of their path touch.
template <class Stage>
struct FirstTouched {
  std::string_view path;
  Stage stage;
};

/// All options that the stages up to `stage` depend on, with their values. Those that `table` does not name touch the
/// first.
template <class Stage, Described O>
std::string options_up_to(Stage stage, std::span<const FirstTouched<Stage>> table, O options) {
  const auto is_needed = [&](const std::string& path) {
    for (const auto& [beginning, first] : table)
      if (path.starts_with(beginning)) return first <= stage;
    return true;
  };
  std::string text;
  for (const OptionRow& row : option_table(options))
    if (is_needed(row.path)) text += row.path + '=' + row.default_value + '\n';
  return text;
}

/// What a stage made last, and what of.
template <class Value>
class Memo {
 public:
  /// The last value, if it was made of the same; else what `make` returns, which is kept.
  template <class F>
  const Value& operator()(std::string made_of, F&& make) {
    if (value_ && made_of_ == made_of) return *value_;
    value_.reset();  // its memory is free while the next is made, and nothing is kept where that fails
    value_.emplace(std::forward<F>(make)());
    made_of_ = std::move(made_of);
    return *value_;
  }

 private:
  std::string made_of_;
  std::optional<Value> value_;
};

}  // namespace dynasurf
