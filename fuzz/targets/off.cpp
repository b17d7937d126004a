#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_off(std::string_view bytes) {
  return decodes_both(bytes, "a.off", io::detail::decode_off, io::detail::decode_off);
}
