#include "dynasurf/dynamics/detail/models.hpp"

#include "dynasurf/dynamics/contour/detail/surface_curvature.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {
namespace {

std::vector<Force> forces_of(const FreeModel&, const TriMesh&, field::FieldView, field::Sampling) { return {}; }

std::vector<Force> forces_of(const SpringModel& o, const TriMesh& start, field::FieldView, field::Sampling) {
  return {spring_force(springs_of(start, o.rest_scale), {o.stiffness, o.damping})};
}

std::vector<Force> forces_of(const RestrictedSpringModel& o, const TriMesh& start, field::FieldView field,
                             field::Sampling sampling) {
  return {
      restricted_spring_force(springs_of(start, o.rest_scale), field, {o.stiffness, o.damping, o.threshold, sampling})};
}

std::vector<Force> forces_of(const PlainModel& o, const TriMesh& start, field::FieldView, field::Sampling) {
  return {stretch_force(start, {o.stretch, o.stretch_damping, o.rest_scale, o.area_unit_mm2}),
          shear_force(start, {o.shear, o.shear_damping, o.area_unit_mm2}),
          bend_force(start, {.stiffness = o.bend, .damping = o.bend_damping})};
}

std::vector<Force> forces_of(const CurvatureModel& o, const TriMesh& start, field::FieldView, field::Sampling) {
  return {surface_curvature_force(start, o.strength)};
}

}  // namespace

std::vector<Force> internal_forces(const ModelOptions& model, const TriMesh& start, field::FieldView field,
                                   field::Sampling sampling) {
  return std::visit([&](const auto& o) { return forces_of(o, start, field, sampling); }, model);
}

SolverOptions solver_for(const ModelOptions& model, const SolverOptions& asked) {
  if (!std::holds_alternative<AutomaticSolver>(asked)) return asked;
  if (std::holds_alternative<FreeModel>(model)) return Rk4{};
  return BackwardEuler{};
}

}  // namespace dynasurf::dynamics
