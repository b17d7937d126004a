// What takes the place of what draws where there is no cairo.
#include "dynasurf/core/error.hpp"

#include "borders_matrix.hpp"
#include "command.hpp"
#include "section_sheet.hpp"

namespace dynasurf::app {

void add_show(CLI::App& /*program*/, Command& /*chosen*/) {}
ExitCode draw_borders(const BordersArguments& /*arguments*/, std::stop_token /*stop*/) {
  throw OptionError("this build draws no pictures; expected --json");
}

void write_section_sheet(const Image& /*image*/, const TriMesh& /*surface*/, const std::string& /*title*/,
                         const std::filesystem::path& /*path*/) {}

}  // namespace dynasurf::app
