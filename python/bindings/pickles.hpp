#pragma once
#include <memory>

#include "bindings.hpp"
#include "clouds.hpp"
#include "heart.hpp"
#include "origin.hpp"

namespace dynasurf::python {

// Objects as bytes that this version of the program reads back. `unpickled` throws InputError for any others.

py::bytes pickled(const OriginStudy& study);
py::bytes pickled(const OriginCloud& cloud);
py::bytes pickled(const Heart& heart);
py::bytes pickled(const Lods& lods);

template <class T>
std::shared_ptr<T> unpickled(const py::bytes& bytes);

/// Pickling of a class.
template <class T>
auto by_pickle() {
  return py::pickle([](const T& object) { return pickled(object); },
                    [](const py::bytes& bytes) { return unpickled<T>(bytes); });
}

}  // namespace dynasurf::python
