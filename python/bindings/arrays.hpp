#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pybind11/numpy.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/grid.hpp"
#include "dynasurf/core/volume.hpp"

#include "bindings.hpp"

namespace dynasurf::python {

/// Arrays of numbers as callers give them: any layout and type that NumPy turns into this one.
template <class T>
using Numbers = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// A NumPy array of memory that `owner` keeps alive.
template <class T, class Owner>
py::array writable_view_of(const T* data, std::vector<py::ssize_t> shape, std::shared_ptr<Owner> owner) {
  using Kept = std::shared_ptr<const void>;
  const py::capsule base(new Kept(std::move(owner)), [](void* kept) { delete static_cast<Kept*>(kept); });
  return py::array_t<T>(std::move(shape), data, base);
}

/// The same, read-only.
template <class T, class Owner>
py::array view_of(const T* data, std::vector<py::ssize_t> shape, std::shared_ptr<Owner> owner) {
  py::array view = writable_view_of(data, std::move(shape), std::move(owner));
  view.attr("flags").attr("writeable") = false;
  return view;
}

/// Vectors of three as an (n, 3) view.
template <class Owner>
py::array view_of(const std::vector<Vec3>& points, const std::shared_ptr<Owner>& owner) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return view_of(reinterpret_cast<const double*>(points.data()), {static_cast<py::ssize_t>(points.size()), 3}, owner);
}

/// Corners as an (n, corners) view of int32, which they fit: no mesh has 2^31 vertices.
template <std::size_t corners, class Owner>
py::array view_of(const std::vector<std::array<std::uint32_t, corners>>& cells, const std::shared_ptr<Owner>& owner) {
  return view_of(reinterpret_cast<const std::int32_t*>(cells.data()),
                 {static_cast<py::ssize_t>(cells.size()), static_cast<py::ssize_t>(corners)}, owner);
}

/// Plain numbers as an (n,) view.
template <class T, class Owner>
py::array view_of_values(const std::vector<T>& values, const std::shared_ptr<Owner>& owner) {
  return view_of(values.data(), {static_cast<py::ssize_t>(values.size())}, owner);
}

/// A volume as a (z, y, x) view.
template <class T, class Owner>
py::array view_of_volume(const Volume<T>& volume, const std::shared_ptr<Owner>& owner) {
  const auto& [x, y, z] = volume.grid.dims;
  return view_of(volume.values.data(), {z, y, x}, owner);
}

/// Rows of three numbers. Throws OptionError naming `what` for another shape.
std::vector<Vec3> points_from(const Numbers<double>& array, const std::string& what);
/// Rows of three indices below `vertices`. Throws as above, InputError for one that is out of range.
std::vector<std::array<std::uint32_t, 3>> triangles_from(const Numbers<std::int64_t>& array, std::size_t vertices);
Vec3 vector_from(const Numbers<double>& array, const std::string& what);
std::string shape_text(const py::array& array);

/// A new array of the numbers of a vector or matrix of Eigen.
py::array array_of(const Vec3& vector);
py::array array_of(const Mat3& matrix);

}  // namespace dynasurf::python
