#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_las(std::string_view bytes) {
  const io_detail::MeshFile file{"a.las", bytes};
  return reads(file.name, [&] {
    io_detail::VertexData data;
    check_mesh(io_detail::decode_las(file, data), false);
  });
}
