#pragma once
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "dynasurf/core/grid.hpp"

// How numbers stand in the files of a result.

namespace dynasurf::report::detail {

using Json = nlohmann::ordered_json;

inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
inline Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

/// Files count gates and slices from 1; -1 inside means none.
inline Json one_based(int index) { return index >= 0 ? Json(index + 1) : Json(nullptr); }
inline Json one_based(const std::optional<int>& index) { return index ? one_based(*index) : Json(nullptr); }

inline Json vector_json(const Vec3& v) { return {number(v[0]), number(v[1]), number(v[2])}; }

/// Shortest text that reads back as the same number, with a point in every locale; empty when there is none.
inline std::string text_of(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return "";
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, *value).ptr};
}

/// The same with a fixed number of decimals.
inline std::string text_of(double value, int decimals) {
  char text[512];  // the largest double has 309 digits
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals).ptr};
}

}  // namespace dynasurf::report::detail
