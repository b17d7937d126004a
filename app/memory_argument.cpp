#include "memory_argument.hpp"

#include <CLI/CLI.hpp>

namespace dynasurf::app {

void add_memory_limit(CLI::App& program, std::string& text) {
  for (const char* command :
       {"ventricle", "cloud", "lod", "edges", "borders", "info", "measure", "rerun", "solid", "motion", "organ"})
    program.get_subcommand(command)->add_option(
        "--memory-limit", text,
        "most memory a job may need, such as 8G or 500M; files that declare more are refused before they are read "
        "(half of the machine's)");
}

}  // namespace dynasurf::app
