#include <optional>

#include "dynasurf/dynamics/evolve.hpp"

#include "arrays.hpp"
#include "options.hpp"
#include "running.hpp"
#include "stages.hpp"
#include "stepper.hpp"

namespace dynasurf::python {
namespace {

Vec3 point_of(const py::object& point) { return vector_from(py::cast<Numbers<double>>(point), "the point of a stop"); }

py::array copy_of(std::span<const Vec3> rows) {
  py::array_t<double> array({static_cast<py::ssize_t>(rows.size()), py::ssize_t{3}});
  std::copy_n(reinterpret_cast<const double*>(rows.data()), 3 * rows.size(), array.mutable_data());
  return array;
}

/// A function of (positions, velocities) that returns the force on every particle.
dynamics::Force force_from(const std::string& name, py::object function) {
  const SharedFunction called = shared_function(std::move(function));
  return {name, [name, called](const dynamics::ParticleState& state, std::span<Vec3> forces) {
            const py::gil_scoped_acquire acquire;
            const py::object told = (*called)(copy_of(state.positions), copy_of(state.velocities));
            const std::vector<Vec3> added = points_from(py::cast<Numbers<double>>(told), "the forces of " + name);
            if (added.size() != forces.size())
              throw OptionError("force " + name + " gave " + std::to_string(added.size()) + " rows; expected " +
                                std::to_string(forces.size()));
            for (std::size_t p = 0; p < added.size(); ++p) forces[p] += added[p];
          }};
}

dynamics::OwnStop stop_from(py::object function) {
  const SharedFunction called = shared_function(std::move(function));
  return [called](const Vec3& from, const Vec3& to) -> std::optional<Vec3> {
    const py::gil_scoped_acquire acquire;
    const py::object point = (*called)(array_of(from), array_of(to));
    if (point.is_none()) return std::nullopt;
    return point_of(point);
  };
}

dynamics::Additions additions_from(const py::dict& forces, const py::object& stop, const std::shared_ptr<Image>& drag) {
  dynamics::Additions own;
  for (const auto& [name, function] : forces)
    own.forces.push_back(force_from(py::cast<std::string>(name), py::reinterpret_borrow<py::object>(function)));
  if (!stop.is_none()) own.stop = stop_from(stop);
  if (drag) own.drag = *drag;
  return own;
}

std::string reason_of(const dynamics::EvolutionResult& result) { return std::string(dynamics::name_of(result.reason)); }

void bind_motion_result(py::module_& module) {
  using R = dynamics::EvolutionResult;
  py::class_<R, std::shared_ptr<R>>(module, "EvolutionResult", "A mesh that was moved, and how its motion ended.")
      .def_property_readonly(
          "mesh", [](const std::shared_ptr<R>& r) { return held(part_of(r, r->mesh)); }, "In the field's grid frame.")
      .def_property_readonly("reason", &reason_of, "all_stopped, at_rest, max_steps or diverged.")
      .def_readonly("steps", &R::steps)
      .def_readonly("step_s", &R::step_s, "Time step, s.")
      .def_readonly("step_explained", &R::step_explained, "What set the first one.")
      .def_readonly("stopped_fraction", &R::stopped_fraction, "Share of the particles that reached their border.")
      .def_property_readonly(
          "stopped", [](const std::shared_ptr<R>& r) { return view_of_values(r->stopped, r); },
          "Reached a border voxel, per vertex, uint8.")
      .def_readonly("notes", &R::notes, "What was remarked.")
      .def("__repr__", [](const R& r) {
        return "<dynasurf.EvolutionResult: " + reason_of(r) + " after " + std::to_string(r.steps) + " steps>";
      });
}

void bind_stepper(py::module_& module) {
  py::class_<Stepper, std::shared_ptr<Stepper>>(module, "Stepper", "A motion that waits after every step.")
      .def("__iter__", [](const std::shared_ptr<Stepper>& self) { return self; })
      .def("__next__",
           [](Stepper& self) {
             const auto state = self.next();
             if (!state) throw py::stop_iteration();
             return py::make_tuple(state->steps, state->mesh);
           })
      .def_property_readonly(
          "result", [](Stepper& self) { return self.result(); }, "The EvolutionResult; None before the end.")
      .def("close", &Stepper::close, "Ends the motion where it stands.");
}

}  // namespace

void bind_dynamics(py::module_& module) {
  using Planes = dynamics::BorderPlanes;
  py::class_<Planes, std::shared_ptr<Planes>>(module, "BorderPlanes", "Where a border runs inside its voxels.");
  bind_motion_result(module);
  bind_stepper(module);
  module.def(
      "evolve",
      [](const std::shared_ptr<TriMesh>& start, const std::shared_ptr<field::VectorField>& field,
         const std::shared_ptr<Image>& border, const std::string& options, const std::shared_ptr<Planes>& planes,
         const py::dict& forces, const py::object& stop, const std::shared_ptr<Image>& drag, py::object progress,
         int threads) {
        const auto how = options_from<dynamics::Evolution>(options);
        dynamics::Additions own = additions_from(forces, stop, drag);
        own.planes = planes.get();
        return run_long_for({std::move(progress), threads}, [=](const Progress& told) {
          return std::make_shared<dynamics::EvolutionResult>(dynamics::evolve(*start, *field, *border, how, told, own));
        });
      },
      needed("start"), needed("field"), needed("border"), needed("options"),
      py::arg("planes") = std::shared_ptr<Planes>(), py::arg("forces") = py::dict(), py::arg("stop") = py::none(),
      py::arg("drag") = std::shared_ptr<Image>(), py::arg("progress") = py::none(), py::arg("threads") = 0);
  module.def(
      "evolve_steps",
      [](const std::shared_ptr<TriMesh>& start, const std::shared_ptr<field::VectorField>& field,
         const std::shared_ptr<Image>& border, const std::string& options, const std::shared_ptr<Planes>& planes,
         const py::dict& forces, const py::object& stop, const std::shared_ptr<Image>& drag, int every) {
        if (every < 1) throw OptionError("every is " + std::to_string(every) + "; expected 1 or more steps");
        return std::make_shared<Stepper>(Motion{start, field, border, options_from<dynamics::Evolution>(options),
                                                planes, additions_from(forces, stop, drag)},
                                         every);
      },
      needed("start"), needed("field"), needed("border"), needed("options"),
      py::arg("planes") = std::shared_ptr<Planes>(), py::arg("forces") = py::dict(), py::arg("stop") = py::none(),
      py::arg("drag") = std::shared_ptr<Image>(), py::arg("every") = 1);
}

}  // namespace dynasurf::python
