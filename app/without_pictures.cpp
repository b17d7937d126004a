// What takes the place of what draws where there is no cairo.
#include "command.hpp"
#include "section_sheet.hpp"

namespace dynasurf::app {

void add_show(CLI::App& /*program*/, Command& /*chosen*/) {}
void add_edges(CLI::App& /*program*/, Command& /*chosen*/) {}
void add_borders(CLI::App& /*program*/, Command& /*chosen*/) {}

void write_section_sheet(const Image& /*image*/, const TriMesh& /*surface*/, const std::string& /*title*/,
                         const std::filesystem::path& /*path*/) {}

}  // namespace dynasurf::app
