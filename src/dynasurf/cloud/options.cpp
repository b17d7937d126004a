#include "dynasurf/cloud/options.hpp"

#include <array>
#include <charconv>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::array<std::string_view, 3> methods{"shaped", "faithful", "thesis"};
constexpr std::array<std::string_view, 3> genus_rules{"auto", "0", "keep"};
constexpr std::array<std::string_view, 5> starts{"auto", "field", "sphere", "ellipsoid", "hull"};
constexpr int fewest_triangles = 20, most_triangles = 2'000'000;

[[noreturn]] void refuse(const std::string& triangles) {
  throw OptionError("option triangles is '" + triangles + "'; expected even numbers from " +
                    std::to_string(fewest_triangles) + " to " + std::to_string(most_triangles) +
                    ", falling, with commas between them");
}

}  // namespace

std::span<const std::string_view> names_of(CloudMethod) { return methods; }
std::span<const std::string_view> names_of(GenusRule) { return genus_rules; }
std::span<const std::string_view> names_of(CloudStart) { return starts; }
std::span<const std::string_view> preset_names() { return methods; }

Options preset(std::string_view name) {
  Options o;
  o.method = static_cast<CloudMethod>(position_of(methods, name, "preset"));
  return o;
}

std::vector<int> parse_triangles(const std::string& triangles) {
  std::vector<int> counts;
  const char *at = triangles.data(), *end = at + triangles.size();
  for (;;) {
    int count = 0;
    const auto [next, error] = std::from_chars(at, end, count);
    const bool in_range = count >= fewest_triangles && count <= most_triangles && count % 2 == 0;
    if (error != std::errc{} || !in_range || (!counts.empty() && count >= counts.back())) refuse(triangles);
    counts.push_back(count);
    if (next == end) return counts;
    if (*next != ',') refuse(triangles);
    at = next + 1;
  }
}

}  // namespace dynasurf::cloud
