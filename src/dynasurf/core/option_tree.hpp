#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "dynasurf/core/options.hpp"

namespace dynasurf {

// An options struct seen without its type: a list of named members that can be read and set. `describe` is compiled
// into this tree once per struct, and everything that speaks of options (JSON, --set, manual tables) works on the tree.

struct OptionNode;
/// The members of an options struct, in the order of `describe`.
using OptionNodes = std::vector<OptionNode>;

/// An enumerator, by its position among its words.
struct WordRef {
  std::span<const std::string_view> words;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// A family of methods, of which one is current.
struct ChoiceRef {
  std::vector<std::string_view> methods;
  std::function<std::size_t()> current;
  /// Makes a method the current one and returns its members. Keeps its options when it is current already, else it
  /// starts from its defaults. Members returned earlier must not be used after another method was chosen.
  std::function<OptionNodes(std::size_t)> choose;
};

/// A struct within a struct.
struct GroupRef {
  OptionNodes members;
};

/// Where the value of an option lies, by its type.
using OptionRef = std::variant<double*, int*, std::uint64_t*, bool*, std::string*, std::optional<double>*,
                               std::optional<int>*, std::vector<int>*, std::vector<double>*,
                               std::optional<std::array<double, 3>>*, WordRef, ChoiceRef, GroupRef>;

/// One member of an options struct. It points into the struct, which must outlive it.
struct OptionNode {
  std::string_view name;
  OptionInfo field;
  OptionRef ref;
};

/// The members of a described struct, which must outlive them, in the order of its `describe`.
template <Described O>
OptionNodes nodes_of(O& options);

/// A family by itself: `choice_of(phantom).choose(2)` makes the third method current and gives its members.
template <class... A>
ChoiceRef choice_of(std::variant<A...>& family);

/// Sets one option from text: "edges.sigma_px=1.8", "field=gvf" or "field.method=gvf" (a method that is current already
/// keeps its options), "labels.coarse.x_px=unset" (an optional number), "triangles=[1280,320]" or "triangles=1280,320"
/// (a list). Throws OptionError, in one line with the full
/// path and the choices, for an unknown path, a wrong type, an unknown word, or a value out of range; the options
/// are unchanged then.
void set_option(const OptionNodes& nodes, std::string_view assignment);
template <Described O>
void set_option(O& options, std::string_view assignment) {
  set_option(nodes_of(options), assignment);
}

/// Sets one option after the other. Methods of a family may share names with defaults of their own, so nothing is
/// carried from one to the next: an assignment that chooses another method begins with its defaults, and OptionError is
/// thrown where one before it has set an option of the family, which would be lost. The assignments before that are
/// made.
void set_options(const OptionNodes& nodes, std::span<const std::string> assignments);
template <Described O>
void set_options(O& options, std::span<const std::string> assignments) {
  set_options(nodes_of(options), assignments);
}

/// One line of the manual.
struct OptionRow {
  std::string path;           // "edges.sigma_px"
  std::string method;         // the method that the option belongs to ("canny"); empty: always there
  std::string default_value;  // as `set_option` reads it
  std::string unit;
  std::string range;    // ">= 0", "0 to 20", empty when anything goes
  std::string choices;  // words or methods, separated by " | "
  std::string doc;
};

/// All options with their present values as defaults; the members of every method of a family follow its row. Groups
/// have no row of their own. The tree is left as it was, except that methods which are not current lose changed
/// options.
std::vector<OptionRow> option_table(const OptionNodes& nodes);
template <Described O>
std::vector<OptionRow> option_table(O options) {
  return option_table(nodes_of(options));
}

// For readers of other notations than text (see io/options_json.hpp).

/// What may stand there: "a number >= 0 and <= 20", "one of entry, centre, backtrack".
std::string expected_of(const OptionNode& node);
/// Throws OptionError "option PATH is VALUE; expected EXPECTED".
[[noreturn]] void throw_wrong_value(const OptionNode& node, const std::string& path, const std::string& value);
/// Throws OptionError "unknown option PATH; did you mean ...? choices: ...".
[[noreturn]] void throw_unknown_option(const OptionNodes& siblings, const std::string& path, std::string_view name,
                                       bool in_family);
/// The position of `word` in `words`, or OptionError with the choices and the nearest word.
std::size_t position_of(std::span<const std::string_view> words, std::string_view word, const std::string& path);
/// Assigns to an option what stands in a text, as `set_option` does.
void assign_text(const OptionNode& node, const std::string& path, std::string_view text);
/// Whether a number may be assigned: finite, in range.
bool in_range(const OptionInfo& field, double value);
std::string join_path(const std::string& path, std::string_view name);

// ---------------------------------------------------------------------------------------------------------------------

template <class... A>
ChoiceRef choice_of(std::variant<A...>& family) {
  ChoiceRef choice;
  choice.methods = {A::name...};
  choice.current = [&family] { return family.index(); };
  choice.choose = [&family](std::size_t wanted) {
    std::size_t position = 0;
    const auto make = [&]<class Method>(std::type_identity<Method>) {
      if (position++ == wanted && family.index() != wanted) family = Method{};
    };
    (make(std::type_identity<A>{}), ...);
    return std::visit([](auto& method) { return nodes_of(method); }, family);
  };
  return choice;
}

namespace detail {

template <class T>
inline constexpr bool is_plain_option =
    std::is_same_v<T, double> || std::is_same_v<T, int> || std::is_same_v<T, std::uint64_t> ||
    std::is_same_v<T, bool> || std::is_same_v<T, std::string> || std::is_same_v<T, std::optional<double>> ||
    std::is_same_v<T, std::optional<int>> || std::is_same_v<T, std::vector<int>> ||
    std::is_same_v<T, std::vector<double>> || std::is_same_v<T, std::optional<std::array<double, 3>>>;

/// Visits the members of a described struct and keeps where they lie.
struct NodeCollector {
  OptionNodes nodes;

  template <class T>
  void operator()(std::string_view name, T& value, const OptionInfo& field) {
    nodes.push_back({name, field, ref_of(value)});
  }

  template <class T>
  static OptionRef ref_of(T& value) {
    if constexpr (is_plain_option<T>) {
      return &value;
    } else if constexpr (NamedEnum<T>) {
      return WordRef{names_of(value), [&value] { return static_cast<std::size_t>(value); },
                     [&value](std::size_t position) { value = static_cast<T>(position); }};
    } else if constexpr (IsVariant<T>::value) {
      return choice_of(value);
    } else {
      static_assert(Described<T>,
                    "an option is a number, bool, text, list, named enum, described struct or variant of them");
      return GroupRef{nodes_of(value)};
    }
  }
};

}  // namespace detail

template <Described O>
OptionNodes nodes_of(O& options) {
  detail::NodeCollector collector;
  describe(collector, options);
  return std::move(collector.nodes);
}

}  // namespace dynasurf
