#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_obj(std::string_view bytes) {
  return decodes_both(bytes, "a.obj", io::detail::decode_obj, io::detail::decode_obj);
}
