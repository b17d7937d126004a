#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_stl(std::string_view bytes) {
  const io_detail::MeshFile file{"a.stl", bytes};
  return reads(file.name, [&] { check_mesh(io_detail::decode_stl(file), true); });
}
