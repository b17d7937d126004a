#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

#include "arrays.hpp"
#include "clouds.hpp"
#include "options.hpp"
#include "origin.hpp"
#include "running.hpp"

namespace dynasurf::python {

void bind_synthetic(py::module_& module) {
  using G = synthetic::TrueGate;
  py::class_<G, std::shared_ptr<G>>(module, "TrueGate", "The surfaces that a gate of a phantom was filled between.")
      .def_property_readonly(
          "endo", [](const std::shared_ptr<G>& g) { return held(part_of(g, g->endo)); }, "TriMesh, world (LPS), mm.")
      .def_property_readonly(
          "epi", [](const std::shared_ptr<G>& g) { return held(part_of(g, g->epi)); }, "TriMesh, world (LPS), mm.")
      .def_readonly("endo_ml", &G::endo_ml)
      .def_readonly("epi_ml", &G::epi_ml)
      .def_readonly("phase", &G::phase);
  using P = synthetic::Phantom;
  py::class_<P, std::shared_ptr<P>>(module, "Phantom", "A study together with its truth.")
      .def_property_readonly(
          "study",
          [](const P& p) {
            const py::gil_scoped_release release;
            return std::make_shared<OriginStudy>(p.study);
          },
          "The Study, a copy.")
      .def_property_readonly(
          "truth",
          [](const std::shared_ptr<P>& p) {
            py::list gates;
            for (const synthetic::TrueGate& gate : p->truth) gates.append(held(part_of(p, gate)));
            return gates;
          },
          "One TrueGate per gate.")
      .def_readonly("kind", &P::kind)
      .def_readonly("edv_ml", &P::edv_ml)
      .def_readonly("esv_ml", &P::esv_ml)
      .def_readonly("ef_percent", &P::ef_percent)
      .def_readonly("fwhm_mm", &P::fwhm_mm)
      .def_readonly("notes", &P::notes);
  module.def(
      "make_phantom",
      [](const std::string& options, int threads) {
        const auto how = family_from<synthetic::PhantomOptions>(options);
        return run_long_for({py::none(), threads}, [how](const Progress&) {
          return std::make_shared<synthetic::Phantom>(synthetic::make_phantom(how));
        });
      },
      needed("options"), py::arg("threads") = 0);
  module.def(
      "make_cloud",
      [](const std::string& options) {
        const auto how = options_from<synthetic::CloudPhantom>(options);
        const py::gil_scoped_release release;
        auto cloud = std::make_shared<OriginCloud>();
        cloud->cloud = synthetic::make_cloud(how);
        cloud->sources = {{"synthetic", cloud->cloud.points.size(), 0}};
        return cloud;
      },
      needed("options"));
}

}  // namespace dynasurf::python
