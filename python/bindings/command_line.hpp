#pragma once
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/options_json.hpp"

namespace dynasurf::python {

/// The first member in which two option objects of one kind differ, as an assignment that --set takes:
/// "field=steady" for another method, else "field.mu=0.15". Empty when they are equal.
std::string first_difference(const nlohmann::ordered_json& from, const nlohmann::ordered_json& to,
                             const std::string& path = "");

/// The assignments of --set that make `from` into `to`, in the order of the options.
template <Described O>
std::vector<std::string> settings_between(O from, O to) {
  std::vector<std::string> settings;
  const auto wanted = io::options_to_json(nodes_of(to));
  while (true) {
    std::string next = first_difference(io::options_to_json(nodes_of(from)), wanted);
    if (next.empty()) return settings;
    set_option(from, next);
    settings.push_back(std::move(next));
  }
}

}  // namespace dynasurf::python
