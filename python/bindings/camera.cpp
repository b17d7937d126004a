#include "dynasurf/synthetic/camera.hpp"

#include "arrays.hpp"
#include "options.hpp"
#include "origin.hpp"
#include "running.hpp"

namespace dynasurf::python {
namespace {

/// Counts of all gates as one new array: they stand apart in memory.
py::array counts_of(const Projections& p, const std::vector<std::vector<float>>& gates) {
  const auto size = static_cast<py::ssize_t>(p.size);
  py::array_t<float> array({static_cast<py::ssize_t>(gates.size()), static_cast<py::ssize_t>(p.views()), size, size});
  float* to = array.mutable_data();
  for (const std::vector<float>& gate : gates) to = std::copy(gate.begin(), gate.end(), to);
  return array;
}

void bind_projections(py::module_& module) {
  using P = Projections;
  py::class_<P, std::shared_ptr<P>>(module, "Projections", "What a rotating camera with parallel holes counted.")
      .def_property_readonly(
          "counts", [](const P& p) { return counts_of(p, p.gates); }, "(gate, view, row, column) float32: a copy.")
      .def_property_readonly(
          "scatter", [](const P& p) { return counts_of(p, p.scatter); },
          "The same: what windows beside the peak say of the scatter in it.")
      .def_readonly("bin_mm", &P::bin_mm, "Size of a bin, mm.")
      .def_readonly("cycle_ms", &P::cycle_ms, "R-R interval, ms; 0: unknown.")
      .def_property_readonly(
          "angle_deg", [](const std::shared_ptr<P>& p) { return view_of_values(p->angle_deg, p); },
          "Where the camera stands, per view: 0 in front of the patient, 90 at his left.")
      .def_property_readonly(
          "radius_mm", [](const std::shared_ptr<P>& p) { return view_of_values(p->radius_mm, p); },
          "From the axis of rotation to the collimator's face, per view.");
}

std::shared_ptr<OriginStudy> copy_of(const Study& study) {
  const py::gil_scoped_release release;
  return std::make_shared<OriginStudy>(study);
}

void bind_acquisition(py::module_& module) {
  using S = synthetic::CameraStudy;
  py::class_<S, std::shared_ptr<S>>(module, "CameraStudy", "A patient, what the camera counted, what was made of it.")
      .def_property_readonly(
          "truth", [](const std::shared_ptr<S>& s) { return held(part_of(s, s->truth)); },
          "Phantom; its study is the activity itself.")
      .def_property_readonly(
          "projections", [](const std::shared_ptr<S>& s) { return held(part_of(s, s->projections)); }, "Projections.")
      .def_property_readonly(
          "attenuation", [](const std::shared_ptr<S>& s) { return held(part_of(s, s->attenuation)); },
          "Image, 1/mm, on the grid of `transaxial`.")
      .def_property_readonly(
          "transaxial", [](const S& s) { return copy_of(s.transaxial); }, "Study, a copy.")
      .def_property_readonly(
          "short_axis", [](const S& s) { return copy_of(s.short_axis); }, "Study, a copy.");
}

}  // namespace

void bind_camera(py::module_& module) {
  bind_projections(module);
  bind_acquisition(module);
  module.def(
      "make_camera_study",
      [](const std::string& options, py::object progress, int threads) {
        const auto how = options_from<synthetic::CameraPhantom>(options);
        return run_long_for({std::move(progress), threads}, [how](const Progress& told) {
          return std::make_shared<synthetic::CameraStudy>(synthetic::make_camera_study(how, told));
        });
      },
      needed("options"), py::arg("progress") = py::none(), py::arg("threads") = 0);
}

}  // namespace dynasurf::python
