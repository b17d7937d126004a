#include "dynasurf/cloud/options.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::array<std::string_view, 3> methods{"shaped", "faithful", "thesis"};
constexpr std::array<std::string_view, 3> genus_rules{"auto", "0", "keep"};
constexpr std::array<std::string_view, 5> starts{"auto", "field", "sphere", "ellipsoid", "hull"};
constexpr std::array<std::string_view, 4> boundaries{"auto", "close", "keep", "trim"};
constexpr std::array<std::string_view, 2> lids{"smooth", "flat"};

}  // namespace

std::span<const std::string_view> names_of(CloudMethod) { return methods; }
std::span<const std::string_view> names_of(GenusRule) { return genus_rules; }
std::span<const std::string_view> names_of(CloudStart) { return starts; }
std::span<const std::string_view> names_of(BoundaryRule) { return boundaries; }
std::span<const std::string_view> names_of(LidRule) { return lids; }
std::span<const std::string_view> preset_names() { return methods; }

Options preset(std::string_view name) {
  Options o;
  o.method = static_cast<CloudMethod>(position_of(methods, name, "preset"));
  return o;
}

void check(const Options& options) {
  Options checked = options;
  check_options(checked, "");
  const bool stays_open = options.boundary == BoundaryRule::keep || options.boundary == BoundaryRule::trim;
  if (options.method == CloudMethod::thesis && stays_open)
    throw OptionError("option boundary is " + std::string(word_of(options.boundary)) +
                      "; method thesis makes closed surfaces only: expected auto or close");
  if (options.lid == LidRule::flat && (stays_open || options.method == CloudMethod::thesis))
    throw OptionError(
        "option lid is flat; it closes the holes of a body: expected boundary auto or close, and method shaped or "
        "faithful");
  const std::vector<int>& levels = options.triangles;
  const bool are_even = std::all_of(levels.begin(), levels.end(), [](int n) { return n % 2 == 0; });
  if (!levels.empty() && are_even && std::is_sorted(levels.rbegin(), levels.rend(), std::less_equal<>{})) return;
  std::string text;
  for (const int n : levels) text.append(text.empty() ? "" : ",").append(std::to_string(n));
  throw OptionError("option triangles is [" + text + "]; expected even numbers that fall");
}

}  // namespace dynasurf::cloud
