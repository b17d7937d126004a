#pragma once
#include <cmath>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/options.hpp"

namespace dynasurf {
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
      const auto number = static_cast<double>(value);
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
