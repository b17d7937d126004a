#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_stl(std::string_view bytes) {
  const io::detail::MeshFile file{"a.stl", bytes};
  return reads(file.name, [&] { check_mesh(io::detail::decode_stl(file), true); });
}
