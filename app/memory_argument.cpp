#include "memory_argument.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <CLI/CLI.hpp>

namespace dynasurf::app {

void add_memory_limit(CLI::App& program, std::string& text) {
  constexpr std::array<std::string_view, 11> readers{"ventricle", "cloud", "lod",    "borders", "info", "measure",
                                                     "rerun",     "solid", "motion", "organ",   "show"};
  const auto reads = [&](CLI::App* command) {
    return std::find(readers.begin(), readers.end(), command->get_name()) != readers.end();
  };
  for (CLI::App* command : program.get_subcommands(reads))
    command->add_option(
        "--memory-limit", text,
        "most memory a job may need, such as 8G or 500M; files that declare more are refused before they are read "
        "(half of the machine's)");
}

}  // namespace dynasurf::app
