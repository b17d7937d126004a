#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_off(std::string_view bytes) {
  return decodes_both(bytes, "a.off", io_detail::decode_off, io_detail::decode_off);
}
