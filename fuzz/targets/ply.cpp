#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_ply(std::string_view bytes) {
  return decodes_both(bytes, "a.ply", io::detail::decode_ply, io::detail::decode_ply);
}
