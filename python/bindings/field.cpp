#include "dynasurf/field/edge_map.hpp"
#include "dynasurf/field/gvf.hpp"

#include "arrays.hpp"
#include "options.hpp"
#include "running.hpp"

namespace dynasurf::python {
namespace {

/// The components stand apart in memory: a tuple of views.
py::tuple components(const std::shared_ptr<field::VectorField>& f) {
  const auto& [x, y, z] = f->grid.dims;
  const std::vector<py::ssize_t> shape{z, y, x};
  return py::make_tuple(view_of(f->x.data(), shape, f), view_of(f->y.data(), shape, f), view_of(f->z.data(), shape, f));
}

py::array stacked(const field::VectorField& f) {
  const auto& [x, y, z] = f.grid.dims;
  py::array_t<float> array({3, z, y, x});
  float* to = array.mutable_data();
  for (const auto* part : {&f.x, &f.y, &f.z}) to = std::copy(part->begin(), part->end(), to);
  return array;
}

std::shared_ptr<field::VectorField> field_from(const Numbers<float>& array, const Grid& grid) {
  const auto& [x, y, z] = grid.dims;
  if (array.ndim() != 4 || array.shape(0) != 3 || array.shape(1) != z || array.shape(2) != y || array.shape(3) != x)
    throw OptionError("array has the shape " + shape_text(array) + "; expected (3, z, y, x) of the grid");
  auto field = std::make_shared<field::VectorField>();
  field->grid = grid;
  const float* from = array.data();
  for (auto* part : {&field->x, &field->y, &field->z}) {
    part->assign(from, from + grid.size());
    from += grid.size();
  }
  return field;
}

void bind_field_result(py::module_& module) {
  using F = field::FlowResult;
  py::class_<F, std::shared_ptr<F>>(module, "FlowResult", "A field and how it was reached.")
      .def_property_readonly(
          "field", [](const std::shared_ptr<F>& r) { return held(part_of(r, r->field)); }, "The VectorField.")
      .def_readonly("iterations", &F::iterations, "Explicit steps, or multigrid cycles.")
      .def_readonly("step", &F::step, "Explicit: time step used; at rest: 0.")
      .def_readonly("residual", &F::residual, "Explicit: largest change of a component per unit of time at the end.")
      .def_readonly("diverged", &F::diverged, "Explicit: the motion blew up; the field is the one before.")
      .def_readonly("error", &F::error, "At rest: estimated relative distance from the converged field.")
      .def_readonly("notes", &F::notes, "What was remarked.");
}

}  // namespace

void bind_field(py::module_& module) {
  using V = field::VectorField;
  py::class_<V, std::shared_ptr<V>>(module, "VectorField", "One vector per voxel, along the axes of its grid, 1/mm.")
      .def(py::init(
               [](const Numbers<float>& array, const std::shared_ptr<Grid>& grid) { return field_from(array, *grid); }),
           needed("array"), needed("grid"))
      .def_property_readonly("components", &components, "x, y, z, each (z, y, x) float32: read-only views.")
      .def_property_readonly("array", &stacked, "(3, z, y, x) float32: a copy, the components stand apart in memory.")
      .def_property_readonly(
          "grid", [](const std::shared_ptr<V>& f) { return held(part_of(f, f->grid)); }, "Where the voxels lie.");
  bind_field_result(module);
  module.def(
      "flow_field",
      [](const std::shared_ptr<Image>& map, const std::string& options, py::object progress, int threads) {
        const auto method = family_from<field::FieldOptions>(options);
        return run_long_for({std::move(progress), threads}, [map, method](const Progress& told) {
          return std::make_shared<field::FlowResult>(field::flow_field(*map, method, told));
        });
      },
      needed("edge_map"), needed("options"), py::arg("progress") = py::none(), py::arg("threads") = 0);
  module.def(
      "edge_map_of",
      [](const std::shared_ptr<Image>& image, const std::string& options) {
        const auto method = options_from<field::EdgeMapOptions>(options);
        const py::gil_scoped_release release;
        return std::make_shared<Image>(field::edge_map_of(*image, method));
      },
      needed("image"), needed("options"));
}

}  // namespace dynasurf::python
