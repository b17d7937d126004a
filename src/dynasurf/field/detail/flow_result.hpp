#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "dynasurf/core/note.hpp"
#include "dynasurf/field/vector_field.hpp"

namespace dynasurf::field {

/// `thesis` divides the diffusion by the voxel's volume whatever the axis (eq. 4.50); `metric` by the squared spacing
/// of each axis, so that the field spreads equally in mm (E59).
enum class GvfScheme { thesis, metric };
std::span<const std::string_view> names_of(GvfScheme);

/// A field on every voxel, and how it was reached.
struct FlowResult {
  VectorField field;
  int iterations = 0;     // explicit steps, or multigrid cycles on the voxels
  double step = 0;        // explicit: time step used; steady: 0
  double residual = 0;    // explicit: largest change of a component per unit of time in the last step
  bool diverged = false;  // explicit: a component passed 10 times the largest gradient; `field` is the one before that
  std::optional<double> error;  // steady: estimated |u - u*| / |u*| against the converged field u*
  Notes notes;                  // "gvf.step_limited", "gvf.diverged", "steady.tolerance_missed"
};

}  // namespace dynasurf::field
