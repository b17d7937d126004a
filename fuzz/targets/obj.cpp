#include "targets/meshes.hpp"

bool dynasurf::fuzz::run_obj(std::string_view bytes) {
  return decodes_both(bytes, "a.obj", io_detail::decode_obj, io_detail::decode_obj);
}
