#include "dynasurf/io/mesh_io.hpp"

#include "input_files.hpp"
#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_glb(std::string_view bytes) {
  InputFiles files;
  const auto path = files.add("levels.glb", bytes);
  return reads(path.string(), [&] {
    for (const io::LodSurface& level : io::read_lod_glb(path)) check_mesh(level.mesh, false);
  });
}
