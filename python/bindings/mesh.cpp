#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/mesh/tetrahedra.hpp"

#include "arrays.hpp"
#include "options.hpp"

namespace dynasurf::python {
namespace {

using Mesh = std::shared_ptr<TriMesh>;
using release_lock = py::call_guard<py::gil_scoped_release>;

py::list polygons_of(const Mesh& mesh, const Numbers<double>& point, const Numbers<double>& normal) {
  py::list polygons;
  for (const auto& polygon : mesh::cross_section(*mesh, vector_from(point, "point"), vector_from(normal, "normal"))) {
    py::array_t<double> rows({static_cast<py::ssize_t>(polygon.size()), py::ssize_t{3}});
    for (std::size_t p = 0; p < polygon.size(); ++p)
      std::copy_n(polygon[p].data(), 3, rows.mutable_data(static_cast<py::ssize_t>(p), 0));
    polygons.append(rows);
  }
  return polygons;
}

void bind_tetrahedra(py::module_& module) {
  using T = mesh::TetMesh;
  py::class_<T, std::shared_ptr<T>>(module, "TetMesh", "A solid of tetrahedra with positive volumes; mm.")
      .def_property_readonly(
          "vertices", [](const std::shared_ptr<T>& t) { return view_of(t->vertices, t); },
          "Places, (n, 3) float64, mm: a read-only view.")
      .def_property_readonly(
          "tetrahedra", [](const std::shared_ptr<T>& t) { return view_of(t->tetrahedra, t); },
          "Vertex indices, (m, 4) int32: a read-only view.");
  module.def(
      "fill_between",
      [](const Mesh& inner, const Mesh& outer, int layers) {
        return std::make_shared<mesh::TetMesh>(mesh::fill_between(*inner, *outer, layers));
      },
      needed("inner"), needed("outer"), py::arg("layers") = 1, release_lock());
}

void bind_quality(py::module_& module) {
  py::class_<mesh::SurfaceCheck>(module, "SurfaceCheck", "What a published surface must be.")
      .def_readonly("closed", &mesh::SurfaceCheck::closed)
      .def_readonly("manifold", &mesh::SurfaceCheck::manifold)
      .def_readonly("oriented", &mesh::SurfaceCheck::oriented)
      .def_readonly("self_intersections", &mesh::SurfaceCheck::self_intersections)
      .def_readonly("flat_triangles", &mesh::SurfaceCheck::flat_triangles)
      .def_property_readonly("valid", &mesh::SurfaceCheck::valid);
  module.def(
      "check_surface", [](const Mesh& mesh) { return mesh::check_surface(*mesh); }, needed("mesh"), release_lock());
  module.def(
      "volume_mm3", [](const Mesh& mesh) { return mesh::volume_mm3(*mesh); }, needed("mesh"), release_lock());
  module.def(
      "volume_mm3", [](const std::shared_ptr<mesh::TetMesh>& solid) { return mesh::volume_mm3(*solid); },
      needed("mesh"), release_lock());
  module.def(
      "area_mm2", [](const Mesh& mesh) { return mesh::area_mm2(*mesh); }, needed("mesh"), release_lock());
  module.def("cross_section", &polygons_of, needed("mesh"), needed("point"), needed("normal"));
}

}  // namespace

void bind_mesh(py::module_& module) {
  module.def(
      "icosphere", [](int level) { return std::make_shared<TriMesh>(mesh::icosphere(level)); }, needed("level"),
      release_lock());
  module.def(
      "start_mesh",
      [](const std::shared_ptr<Image>& border, int level, const std::string& options, const Mesh& given) {
        const auto placement = options_from<mesh::Placement>(options);
        const py::gil_scoped_release release;
        return std::make_shared<TriMesh>(mesh::start_mesh(*border, level, placement, given.get()));
      },
      needed("border"), needed("level"), needed("placement"), py::arg("given") = Mesh());
  module.def(
      "to_world",
      [](const std::shared_ptr<Grid>& grid, const Mesh& mesh) {
        return std::make_shared<TriMesh>(to_world(*grid, *mesh));
      },
      needed("grid"), needed("mesh"));
  module.def(
      "to_grid",
      [](const std::shared_ptr<Grid>& grid, const Mesh& mesh) {
        return std::make_shared<TriMesh>(to_grid(*grid, *mesh));
      },
      needed("grid"), needed("mesh"));
  module.def(
      "voxel_parts",
      [](const std::shared_ptr<Grid>& grid, const Mesh& mesh) {
        return std::make_shared<Image>(mesh::voxel_parts(*grid, *mesh));
      },
      needed("grid"), needed("mesh"), release_lock(),
      "Part of each voxel (0 to 1) inside a closed mesh given in the grid frame, exact but for rounding.");
  bind_tetrahedra(module);
  bind_quality(module);
}

}  // namespace dynasurf::python
