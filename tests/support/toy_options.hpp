#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dynasurf/core/options.hpp"

namespace dynasurf::test {

// An options struct with a member of every kind.

enum class Colour { red, green, blue };
inline std::span<const std::string_view> names_of(Colour) {
  static constexpr std::array<std::string_view, 3> names{"red", "green", "blue"};
  return names;
}

struct ToyBlur {
  static constexpr std::string_view name = "blur";
  double sigma = 1;
};
void describe(auto& visit, ToyBlur& o) { visit("sigma", o.sigma, OptionInfo{"width", "px", 0, 10}); }

struct ToyEdge {
  static constexpr std::string_view name = "edge";
  int gain = 3;
};
void describe(auto& visit, ToyEdge& o) { visit("gain", o.gain, OptionInfo{"factor"}); }

struct ToyInner {
  int depth = 2;
};
void describe(auto& visit, ToyInner& o) { visit("depth", o.depth, OptionInfo{"how deep", "", -5, 5}); }

struct Toy {
  double width_mm = 1.25;
  int rounds = 10;
  std::uint64_t seed = 1;
  std::string title = "toy";
  bool strict = false;
  Colour colour = Colour::green;
  std::optional<int> limit;
  std::vector<int> counts{3, 2};
  std::optional<std::array<double, 3>> place_mm;
  ToyInner inner;
  std::variant<ToyBlur, ToyEdge> step;
};
void describe(auto& visit, Toy& o) {
  visit("width_mm", o.width_mm, OptionInfo{"how wide", "mm", 0, 20});
  visit("rounds", o.rounds, OptionInfo{"how often", "", 1});
  visit("seed", o.seed, OptionInfo{"of the random numbers"});
  visit("title", o.title, OptionInfo{"a text"});
  visit("strict", o.strict, OptionInfo{"no mercy"});
  visit("colour", o.colour, OptionInfo{"a word"});
  visit("limit", o.limit, OptionInfo{"may be unset", "", 0, 100});
  visit("counts", o.counts, OptionInfo{"a list", "", 0, 9});
  visit("place_mm", o.place_mm, OptionInfo{"three numbers", "mm"});
  visit("inner", o.inner, OptionInfo{"a group"});
  visit("step", o.step, OptionInfo{"a family"});
}

}  // namespace dynasurf::test
