#include "bindings.hpp"
#include "running.hpp"
#include "version.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace dynasurf::python;
  module.doc() = "The C++ rooms of Dynasurf. Import `dynasurf` instead.";
  module.attr("version") = dynasurf::app::version();
  module.attr("commit") = dynasurf::app::commit();
  bind_core(module);
  bind_options(module);
  bind_image(module);
  bind_field(module);
  bind_mesh(module);
  bind_dynamics(module);
  bind_io(module);
  bind_synthetic(module);
  bind_camera(module);
  bind_ventricle(module);
  bind_cloud(module);
  module.def("wait_for_abandoned", &wait_for_abandoned, "Waits for work that was asked to stop and has not ended.");
}
