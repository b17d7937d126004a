#pragma once
#include <string>

namespace dynasurf::cloud {

/// A share of 1 as notes say it: "12.3 %".
inline std::string percent(double share) {
  const std::string text = std::to_string(100 * share);
  return text.substr(0, text.find('.') + 2) + " %";
}

/// "1 hole", "3 holes".
inline std::string number(int count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace dynasurf::cloud
