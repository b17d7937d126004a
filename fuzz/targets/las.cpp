#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_las(std::string_view bytes) {
  const io::detail::MeshFile file{"a.las", bytes};
  return reads(file.name, [&] {
    io::detail::VertexData data;
    check_mesh(io::detail::decode_las(file, data), false);
  });
}
