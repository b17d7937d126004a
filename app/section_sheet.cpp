#include "section_sheet.hpp"

#include "dynasurf/show/detail/sheets.hpp"

namespace dynasurf::app {

void write_section_sheet(const Image& image, const TriMesh& surface, const std::string& title,
                         const std::filesystem::path& path) {
  show::write_drawing(show::draw_sections(image, surface, title), path, show::DrawingFormat::png);
}

}  // namespace dynasurf::app
