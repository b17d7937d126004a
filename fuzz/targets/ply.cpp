#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_ply(std::string_view bytes) {
  return decodes_both(bytes, "a.ply", io_detail::decode_ply, io_detail::decode_ply);
}
