#include <cmath>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/study.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/io/study_io.hpp"

#include "arrays.hpp"
#include "origin.hpp"
#include "pickles.hpp"

namespace dynasurf::python {

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t d = 0; d < array.ndim(); ++d) text += (d > 0 ? ", " : "") + std::to_string(array.shape(d));
  return text + ")";
}

std::vector<Vec3> points_from(const Numbers<double>& array, const std::string& what) {
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw OptionError(what + " have the shape " + shape_text(array) + "; expected (n, 3)");
  const auto* rows = reinterpret_cast<const Vec3*>(array.data());
  return {rows, rows + array.shape(0)};
}

std::vector<std::array<std::uint32_t, 3>> triangles_from(const Numbers<std::int64_t>& array, std::size_t vertices) {
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw OptionError("triangles have the shape " + shape_text(array) + "; expected (m, 3)");
  std::vector<std::array<std::uint32_t, 3>> triangles(static_cast<std::size_t>(array.shape(0)));
  const std::int64_t* corner = array.data();
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t& index : triangles[t]) {
      if (*corner < 0 || static_cast<std::uint64_t>(*corner) >= vertices)
        throw InputError("triangle " + std::to_string(t) + " has the corner " + std::to_string(*corner) +
                         "; expected 0 to " + std::to_string(vertices) + " less 1");
      index = static_cast<std::uint32_t>(*corner++);
    }
  return triangles;
}

Vec3 vector_from(const Numbers<double>& array, const std::string& what) {
  if (array.size() != 3) throw OptionError(what + " has the shape " + shape_text(array) + "; expected (3,)");
  return {array.data()[0], array.data()[1], array.data()[2]};
}

py::array array_of(const Vec3& vector) { return py::array_t<double>(3, vector.data()); }

py::array array_of(const Mat3& matrix) {
  py::array_t<double> array({3, 3});
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) array.mutable_at(r, c) = matrix(r, c);
  return array;
}

namespace {

/// Voxel (i, j, k) to the world (LPS, mm).
py::array affine_of(const Grid& grid) {
  py::array_t<double> affine({4, 4});
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      affine.mutable_at(r, c) = r == 3  ? (c == 3 ? 1 : 0)
                                : c < 3 ? grid.direction(r, c) * grid.spacing[c]
                                        : grid.origin[r];
  return affine;
}

void set_affine(Grid& grid, const Numbers<double>& affine) {
  if (affine.ndim() != 2 || affine.shape(0) != 4 || affine.shape(1) != 4)
    throw OptionError("affine has the shape " + shape_text(affine) + "; expected (4, 4)");
  for (int c = 0; c < 3; ++c) {
    const Vec3 axis(affine.at(0, c), affine.at(1, c), affine.at(2, c));
    grid.spacing[c] = axis.norm();
    grid.direction.col(c) = axis / grid.spacing[c];
    grid.origin[c] = affine.at(c, 3);
  }
  const Mat3 product = grid.direction.transpose() * grid.direction;
  if (!((product - Mat3::Identity()).cwiseAbs().maxCoeff() < 1e-4) || !grid.origin.allFinite())
    throw OptionError("affine has axes that are not at right angles; expected a rotation, spacings and an origin");
}

Grid grid_from(Index3 dims, const py::object& spacing, const py::object& affine) {
  Grid grid;
  grid.dims = dims;
  if (!affine.is_none()) set_affine(grid, py::cast<Numbers<double>>(affine));
  if (!spacing.is_none()) {
    const Vec3 mm = vector_from(py::cast<Numbers<double>>(spacing), "spacing");
    if (!(mm.minCoeff() > 0) || !mm.allFinite())
      throw OptionError("spacing is not positive; expected mm along x, y, z");
    if (!affine.is_none() && !mm.isApprox(grid.spacing, 1e-4))
      throw OptionError("spacing is not that of affine; expected one of them, or the same in both");
    if (affine.is_none()) grid.spacing = mm;
  }
  if (spacing.is_none() && affine.is_none())
    throw OptionError("neither spacing nor affine is given; expected one of them: an array does not tell its size");
  return grid;
}

template <class T>
std::shared_ptr<Volume<T>> volume_from(const Numbers<T>& array, const py::object& spacing, const py::object& affine) {
  if (array.ndim() != 3 || array.size() == 0)
    throw OptionError("array has the shape " + shape_text(array) + "; expected (z, y, x), none of them 0");
  const auto side = [&](int axis) { return static_cast<int>(array.shape(axis)); };
  auto volume = std::make_shared<Volume<T>>();
  volume->grid = grid_from({side(2), side(1), side(0)}, spacing, affine);
  volume->values.assign(array.data(), array.data() + array.size());
  return volume;
}

/// A volume of zeros and the one array through which it can be written.
template <class T>
py::tuple volume_to_fill(Index3 shape, const py::object& spacing, const py::object& affine) {
  for (const int side : shape)
    if (side < 1) throw OptionError("shape has a side below 1; expected (z, y, x)");
  auto volume = std::make_shared<Volume<T>>(grid_from({shape[2], shape[1], shape[0]}, spacing, affine));
  return py::make_tuple(volume, writable_view_of(volume->values.data(), {shape[0], shape[1], shape[2]}, volume));
}

template <class T>
void bind_volume(py::module_& module, const char* name, const char* doc) {
  using V = Volume<T>;
  py::class_<V, std::shared_ptr<V>>(module, name, doc)
      .def(py::init(&volume_from<T>), needed("array"), py::arg("spacing") = py::none(), py::arg("affine") = py::none(),
           "Values are copied once, as the library owns what it works on; `to_fill` needs no copy.")
      .def_static("to_fill", &volume_to_fill<T>, needed("shape"), py::arg("spacing") = py::none(),
                  py::arg("affine") = py::none(),
                  "A volume of zeros and a writable array (z, y, x) of its own memory, for work without a copy. Write "
                  "before others use it.")
      .def_property_readonly(
          "array", [](const std::shared_ptr<V>& v) { return view_of_volume(*v, v); },
          "Values, (z, y, x): a read-only view of the volume's own memory.")
      .def_property_readonly(
          "grid", [](const std::shared_ptr<V>& v) { return held(part_of(v, v->grid)); }, "Where the voxels lie.")
      .def_property_readonly(
          "affine", [](const V& v) { return affine_of(v.grid); },
          "Voxel (i, j, k) to the world (LPS, mm), (4, 4) float64.")
      .def("__repr__", [name = std::string(name)](const V& v) {
        TextOutput text;
        text << "<dynasurf." << name << " of " << v.grid.dims[0] << " x " << v.grid.dims[1] << " x " << v.grid.dims[2]
             << " voxels>";
        return text.str();
      });
}

View view_from(const std::string& word) {
  for (int v = 0; v <= static_cast<int>(View::transaxial); ++v)
    if (word == name_of(static_cast<View>(v))) return static_cast<View>(v);
  throw OptionError("view is '" + word +
                    "'; expected unknown, short_axis, horizontal_long_axis, vertical_long_axis or transaxial");
}

SliceOrder slice_order_from(const std::string& word) {
  for (int o = 0; o <= static_cast<int>(SliceOrder::base_to_apex); ++o)
    if (word == name_of(static_cast<SliceOrder>(o))) return static_cast<SliceOrder>(o);
  throw OptionError("slice_order is '" + word + "'; expected unknown, apex_to_base or base_to_apex");
}

/// A study of gates on one grid that have no values yet. Throws OptionError.
std::shared_ptr<OriginStudy> described_study(Index3 dims, std::size_t gates, const py::object& spacing,
                                             const py::object& affine, std::vector<double> time_ms, double cycle_ms,
                                             const std::string& modality, const std::string& view,
                                             const std::string& slice_order) {
  if (!time_ms.empty() && time_ms.size() != gates)
    throw OptionError("time_ms has " + std::to_string(time_ms.size()) + " numbers; expected one for each of the " +
                      std::to_string(gates) + " gates");
  if (!(cycle_ms >= 0) || !std::isfinite(cycle_ms)) throw OptionError("cycle_ms is negative; expected ms, 0: unknown");
  auto study = std::make_shared<OriginStudy>();
  study->gates.resize(gates);
  const Grid grid = grid_from(dims, spacing, affine);
  for (Image& gate : study->gates) gate.grid = grid;
  study->time_ms = std::move(time_ms);
  study->cycle_ms = cycle_ms;
  study->format = "array";
  study->modality = modality;
  study->view = view_from(view);
  study->slice_order = slice_order_from(slice_order);
  return study;
}

std::shared_ptr<OriginStudy> study_from(const Numbers<float>& array, const py::object& spacing,
                                        const py::object& affine, std::vector<double> time_ms, double cycle_ms,
                                        const std::string& modality, const std::string& view,
                                        const std::string& slice_order) {
  const py::ssize_t n = array.ndim();
  if ((n != 3 && n != 4) || array.size() == 0)
    throw OptionError("array has the shape " + shape_text(array) + "; expected (gate, z, y, x) or (z, y, x)");
  const auto side = [&](py::ssize_t from_end) { return static_cast<int>(array.shape(n - from_end)); };
  const std::size_t gates = n == 4 ? static_cast<std::size_t>(array.shape(0)) : 1;
  auto study = described_study({side(1), side(2), side(3)}, gates, spacing, affine, std::move(time_ms), cycle_ms,
                               modality, view, slice_order);
  const float* first = array.data();
  for (Image& gate : study->gates) {
    gate.values.assign(first, first + gate.grid.size());
    first += gate.grid.size();
  }
  return study;
}

/// A study of zeros and the arrays through which its gates can be written.
py::tuple study_to_fill(std::array<int, 4> shape, const py::object& spacing, const py::object& affine,
                        std::vector<double> time_ms, double cycle_ms, const std::string& modality,
                        const std::string& view, const std::string& slice_order) {
  for (const int side : shape)
    if (side < 1) throw OptionError("shape has a side below 1; expected (gate, z, y, x)");
  const auto& [gates, z, y, x] = shape;
  auto study = described_study({x, y, z}, static_cast<std::size_t>(gates), spacing, affine, std::move(time_ms),
                               cycle_ms, modality, view, slice_order);
  py::list arrays;
  for (Image& gate : study->gates) {
    gate = Image(gate.grid);
    arrays.append(writable_view_of(gate.values.data(), {z, y, x}, study));
  }
  return py::make_tuple(study, arrays);
}

/// All gates as one new array: they stand apart in memory.
py::array all_gates_of(const Study& study) {
  const auto& [x, y, z] = study.grid().dims;
  py::array_t<float> array({static_cast<int>(study.gates.size()), z, y, x});
  float* to = array.mutable_data();
  for (const Image& gate : study.gates) to = std::copy(gate.values.begin(), gate.values.end(), to);
  return array;
}

void bind_study(py::module_& module) {
  using S = OriginStudy;
  py::class_<S, std::shared_ptr<S>>(module, "Study", "A heart study: one volume per gate, all on one grid.",
                                    py::dynamic_attr())
      .def(py::init(&study_from), needed("array"), py::arg("spacing") = py::none(), py::arg("affine") = py::none(),
           py::arg("time_ms") = std::vector<double>(), py::arg("cycle_ms") = 0.0, py::arg("modality") = "",
           py::arg("view") = "unknown", py::arg("slice_order") = "unknown",
           "Values are copied once, as the library owns what it works on; `to_fill` needs no copy.")
      .def_static("to_fill", &study_to_fill, needed("shape"), py::arg("spacing") = py::none(),
                  py::arg("affine") = py::none(), py::arg("time_ms") = std::vector<double>(), py::arg("cycle_ms") = 0.0,
                  py::arg("modality") = "", py::arg("view") = "unknown", py::arg("slice_order") = "unknown",
                  "A study of zeros, and for each gate the writable array (z, y, x) of its own memory, for work "
                  "without a copy. `shape` is (gate, z, y, x). Write before others use it.")
      .def_property_readonly(
          "gates",
          [](const std::shared_ptr<S>& s) {
            py::list gates;
            for (const Image& gate : s->gates) gates.append(held(part_of(s, gate)));
            return gates;
          },
          "The volumes, one Image per gate.")
      .def_property_readonly(
          "array", [](const S& s) { return all_gates_of(s); }, "All gates, (gate, z, y, x) float32: a copy.")
      .def_property_readonly(
          "grid", [](const std::shared_ptr<S>& s) { return held(part_of(s, s->grid())); }, "Where the voxels lie.")
      .def_property_readonly(
          "affine", [](const S& s) { return affine_of(s.grid()); },
          "Voxel (i, j, k) to the world (LPS, mm), (4, 4) float64.")
      .def_readonly("time_ms", &S::time_ms, "Start of each gate after the R wave, ms; empty: unknown.")
      .def_readonly("cycle_ms", &S::cycle_ms, "R-R interval, ms; 0: unknown.")
      .def_readonly("format", &S::format, "DICOM, NIfTI, NRRD, synthetic or array.")
      .def_readonly("modality", &S::modality, "DICOM's word: NM, PT, MR, CT; empty: not told.")
      .def_readonly("notes", &S::notes, "What the reader remarked.")
      .def_property_readonly(
          "view", [](const S& s) { return std::string(name_of(s.view)); }, "How slices cut the heart.")
      .def_property_readonly(
          "slice_order", [](const S& s) { return std::string(name_of(s.slice_order)); },
          "Which end of the ventricle comes first.")
      .def_property_readonly(
          "attenuation", [](const S& s) { return std::string(name_of(s.attenuation)); },
          "What the reconstruction did about attenuation: unknown, uncorrected or corrected.")
      .def(by_pickle<S>())
      .def("__len__", [](const S& s) { return s.gates.size(); })
      .def("__repr__", [](const S& s) {
        TextOutput text;
        const Index3& d = s.grid().dims;
        text << "<dynasurf.Study of " << s.gates.size() << " gates of " << d[0] << " x " << d[1] << " x " << d[2]
             << " voxels, " << s.format << '>';
        return text.str();
      });
}

void bind_grid(py::module_& module) {
  py::class_<Grid, std::shared_ptr<Grid>>(module, "Grid", "A lattice of voxels placed in the patient (LPS, mm).")
      .def_readonly("dims", &Grid::dims, "Voxels along i, j, k (x, y, z).")
      .def_property_readonly(
          "spacing", [](const Grid& g) { return python::array_of(g.spacing); },
          "mm between voxel centres along i, j, k.")
      .def_property_readonly(
          "origin", [](const Grid& g) { return python::array_of(g.origin); },
          "World position of the centre of voxel (0, 0, 0), mm.")
      .def_property_readonly(
          "direction", [](const Grid& g) { return python::array_of(g.direction); },
          "Columns: world directions of i, j, k.")
      .def_property_readonly("affine", &affine_of, "Voxel (i, j, k) to the world (LPS, mm), (4, 4) float64.");
}

void bind_mesh_and_cloud(py::module_& module) {
  using M = TriMesh;
  py::class_<M, std::shared_ptr<M>>(module, "TriMesh", "Triangles, counter-clockwise seen from outside; mm.")
      .def(py::init([](const Numbers<double>& vertices, const Numbers<std::int64_t>& triangles) {
             auto mesh = std::make_shared<M>();
             mesh->vertices = points_from(vertices, "vertices");
             mesh->triangles = triangles_from(triangles, mesh->vertices.size());
             return mesh;
           }),
           needed("vertices"), needed("triangles"),
           "Both are copied: the library owns what it works on, and indices that were checked must not change. "
           "`to_fill` gives vertices without a copy.")
      .def_static(
          "to_fill",
          [](std::size_t vertices, const Numbers<std::int64_t>& triangles) {
            auto mesh = std::make_shared<M>();
            mesh->vertices.assign(vertices, Vec3::Zero());
            mesh->triangles = triangles_from(triangles, vertices);
            return py::make_tuple(mesh, writable_view_of(reinterpret_cast<double*>(mesh->vertices.data()),
                                                         {static_cast<py::ssize_t>(vertices), 3}, mesh));
          },
          needed("vertices"), needed("triangles"),
          "A mesh of so many vertices at the origin and the writable array (vertices, 3) of their own memory, for work "
          "without a copy. Write before others use it.")
      .def_property_readonly(
          "vertices", [](const std::shared_ptr<M>& m) { return view_of(m->vertices, m); },
          "Places, (n, 3) float64, mm: a read-only view.")
      .def_property_readonly(
          "triangles", [](const std::shared_ptr<M>& m) { return view_of(m->triangles, m); },
          "Vertex indices, (m, 3) int32: a read-only view.")
      .def(py::pickle(
          [](const std::shared_ptr<M>& m) { return py::make_tuple(view_of(m->vertices, m), view_of(m->triangles, m)); },
          [](const py::tuple& state) {
            auto mesh = std::make_shared<M>();
            mesh->vertices = points_from(py::cast<Numbers<double>>(state[0]), "vertices");
            mesh->triangles = triangles_from(py::cast<Numbers<std::int64_t>>(state[1]), mesh->vertices.size());
            return mesh;
          }))
      .def("__repr__", [](const M& m) {
        return "<dynasurf.TriMesh of " + std::to_string(m.vertices.size()) + " vertices and " +
               std::to_string(m.triangles.size()) + " triangles>";
      });
}

void bind_note(py::module_& module) {
  py::class_<Note>(module, "Note", "Something about the data that the user must hear of.")
      .def_property_readonly(
          "severity", [](const Note& n) { return std::string(name_of(n.severity)); }, "info, warning or failure.")
      .def_readonly("code", &Note::code, "Stable, lower case, dotted.")
      .def_readonly("message", &Note::message, "One sentence in plain words.")
      .def_readonly("gate", &Note::gate, "From 0; -1: not about one gate.")
      .def_readonly("slice", &Note::slice, "From 0 at the apex; -1: not about one slice.")
      .def("__repr__", [](const Note& n) {
        return "<" + std::string(name_of(n.severity)) + " " + n.code + ": " + n.message + ">";
      });
}

}  // namespace

void bind_core(py::module_& module) {
  // The last one that is registered is asked first.
  py::register_exception<Cancelled>(module, "Cancelled", PyExc_RuntimeError).attr("__doc__") = "The work was stopped.";
  py::register_exception<IoError>(module, "IoError", PyExc_OSError).attr("__doc__") =
      "A file could not be read or written.";
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).attr("__doc__") =
      "The content of an input is not what it must be.";
  py::register_exception<OptionError>(module, "OptionError", PyExc_ValueError).attr("__doc__") =
      "An option or argument is not what it must be.";
  bind_note(module);
  bind_grid(module);
  bind_volume<float>(module, "Image", "Numbers per voxel, float32.");
  bind_volume<std::uint8_t>(module, "Mask", "Small whole numbers per voxel, uint8.");
  bind_study(module);
  bind_mesh_and_cloud(module);
}

}  // namespace dynasurf::python
