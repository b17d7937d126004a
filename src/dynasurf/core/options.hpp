#pragma once
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf {

/// What a person needs to know of one option. The default is the member's initialiser.
struct OptionInfo {
  std::string_view doc;        // one line: what it does, what its ends mean, thesis reference where there is one
  std::string_view unit = "";  // "mm", "px", "ms"; empty for a pure number
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

// An options struct O has public members with defaults, and beside it
//
//     void describe(auto& visit, O& o) { visit("mu", o.mu, OptionInfo{"balance of smoothing and data", "", 0}); ... }
//
// Members may be double, int, bool, std::string, std::vector<int|double>, an enum with
// `std::span<const std::string_view> names_of(E)`, another described struct,
// std::optional<double|int|std::array<double, 3>>, or a std::variant of described structs. Each alternative of a
// variant has a `static constexpr std::string_view name`; in JSON it is an object with "method": name. JSON, --set, the
// manual's tables, the report and the law tests all read this one description.

namespace detail {
/// Stands for whatever visits the members of a described struct.
struct AnyVisitor {
  template <class T>
  void operator()(std::string_view, T&, const OptionInfo&) {}
};
}  // namespace detail

/// A struct with a `describe` beside it.
template <class O>
concept Described = requires(detail::AnyVisitor& v, O& o) {
  describe(v, o);
};

/// An enumeration whose enumerators have words.
template <class E>
concept NamedEnum = std::is_enum_v<E> && requires(E e) {
  { names_of(e) } -> std::convertible_to<std::span<const std::string_view>>;
};

/// The word of an enumerator, as it stands in JSON.
template <NamedEnum E>
std::string_view word_of(E e) {
  return names_of(e)[static_cast<std::size_t>(e)];
}

/// Whether a type is a std::variant, and likewise a std::optional.
template <class T>
struct IsVariant : std::false_type {};
template <class... A>
struct IsVariant<std::variant<A...>> : std::true_type {};

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// Whether a type is a list of numbers.
template <class T>
struct IsNumberList : std::false_type {};
template <class Number>
struct IsNumberList<std::vector<Number>> : std::true_type {};
template <>
struct IsNumberList<std::array<double, 3>> : std::true_type {};

/// Throws OptionError unless every number of `options` (and of what it holds) lies in its range and is finite.
/// Call it at the public door of a stage: `check_options(options, "gvf")`.
template <Described O>
void check_options(O& options, const std::string& path);

// --------------------------------------------------------------------------------------------------------------

namespace detail {

struct RangeCheck {
  std::string path;

  template <class T>
  void operator()(std::string_view name, T& value, const OptionInfo& field) {
    const std::string here = path.empty() ? std::string(name) : path + "." + std::string(name);
    if constexpr (Described<T>) {
      check_options(value, here);
    } else if constexpr (IsVariant<T>::value) {
      std::visit([&](auto& alternative) { check_options(alternative, here); }, value);
    } else if constexpr (IsOptional<T>::value) {
      if (value) (*this)(name, *value, field);
    } else if constexpr (IsNumberList<T>::value) {
      for (const auto number : value) (*this)(name, number, field);
    } else if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
      const double number = value;
      if (std::isfinite(number) && number >= field.min && number <= field.max) return;
      TextOutput text;
      text << "option " << here << " is " << number << "; expected a number";
      if (std::isfinite(field.min)) text << " >= " << field.min;
      if (std::isfinite(field.min) && std::isfinite(field.max)) text << " and";
      if (std::isfinite(field.max)) text << " <= " << field.max;
      throw OptionError(text.str());
    }
  }
};

}  // namespace detail

template <Described O>
void check_options(O& options, const std::string& path) {
  detail::RangeCheck check{path};
  describe(check, options);
}

}  // namespace dynasurf
