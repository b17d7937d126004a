#pragma once
// What the rooms of the Python module share. One source binds one room of the library.

#include <memory>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace dynasurf::python {

namespace py = pybind11;

void bind_core(py::module_& module);
void bind_options(py::module_& module);
void bind_image(py::module_& module);
void bind_field(py::module_& module);
void bind_mesh(py::module_& module);
void bind_dynamics(py::module_& module);
void bind_ventricle(py::module_& module);
void bind_cloud(py::module_& module);
void bind_io(py::module_& module);
void bind_synthetic(py::module_& module);
/// The rotating camera of the same room.
void bind_camera(py::module_& module);
/// The last stages of the ventricle: fitting and measuring walls.
void bind_walls(py::module_& module);

/// An argument that may not be None, which pybind11 would hand over as a null pointer.
inline py::arg needed(const char* name) { return py::arg(name).none(false); }

/// A reference to a member that keeps its owner alive: a gate's mesh stays valid after Python drops the result.
template <class Whole, class Part>
std::shared_ptr<const Part> part_of(const std::shared_ptr<Whole>& whole, const Part& part) {
  return {whole, &part};
}

/// The same of a part that may be absent, which Python sees as None.
template <class Whole, class Optional>
auto part_of_optional(const std::shared_ptr<Whole>& whole, const Optional& part) {
  return part ? part_of(whole, *part) : nullptr;
}

/// pybind11's holders are not const. What Python holds has no setter, so nothing is changed through them.
template <class T>
std::shared_ptr<T> held(std::shared_ptr<const T> part) {
  return std::const_pointer_cast<T>(std::move(part));
}

}  // namespace dynasurf::python
