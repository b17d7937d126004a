#pragma once
#include <filesystem>
#include <string>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::app {

/// Writes a surface (world frame) over the slices that it meets as PNG; nothing where the program was built without
/// cairo.
void write_section_sheet(const Image& image, const TriMesh& surface, const std::string& title,
                         const std::filesystem::path& path);

}  // namespace dynasurf::app
