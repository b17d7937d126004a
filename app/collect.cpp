#include "cohort_tables.hpp"
#include "command.hpp"

#include <CLI/CLI.hpp>
namespace dynasurf::app {
void collect_cohort(const std::filesystem::path&, const std::filesystem::path&, bool) {}
void add_collect(CLI::App&, Command&) {}
}  // namespace dynasurf::app
