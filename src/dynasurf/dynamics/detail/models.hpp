#pragma once
#include <string_view>
#include <variant>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/dynamics/particles.hpp"
#include "dynasurf/dynamics/solvers/detail/solver_options.hpp"
#include "dynasurf/field/detail/field_view.hpp"

namespace dynasurf::dynamics {

// Deformable models (thesis 3.4): what the particles of a mesh know of each other. The field, drag, stop and smoothing
// are common to all.

/// No internal forces (MOD-FREE, thesis 3.4.5).
struct FreeModel {
  static constexpr std::string_view name = "free";
};
void describe(auto&, FreeModel&) {}

/// Springs along the edges (MOD-SPRING, thesis 3.4.3).
struct SpringModel {
  static constexpr std::string_view name = "spring";
  double stiffness = 10;
  double damping = 1;
  double rest_scale = 0.67;
};
void describe(auto& visit, SpringModel& o) {
  visit("stiffness", o.stiffness, OptionInfo{"k_s: pull of a spring per mm", "kg/s2", 0, 1e9});
  visit("damping", o.damping, OptionInfo{"k_d: pull of a spring against its change of length", "kg/s", 0, 1e9});
  visit("rest_scale", o.rest_scale,
        OptionInfo{"length at rest, of that in the start mesh; 0.67 is the size of the data in a start placed at 1.5",
                   "", 0, 100});
}

/// Springs that act across the field only, where there is one (MOD-RSPRING, thesis 3.4.4).
struct RestrictedSpringModel {
  static constexpr std::string_view name = "restricted_spring";
  double stiffness = 10;
  double damping = 1;
  double rest_scale = 0.67;
  double threshold = 1e-3;
};
void describe(auto& visit, RestrictedSpringModel& o) {
  visit("stiffness", o.stiffness, OptionInfo{"k_s: pull of a spring per mm", "kg/s2", 0, 1e9});
  visit("damping", o.damping, OptionInfo{"k_d: pull of a spring against its change of length", "kg/s", 0, 1e9});
  visit("rest_scale", o.rest_scale,
        OptionInfo{"length at rest, of that in the start mesh; 0.67 is the size of the data in a start placed at 1.5",
                   "", 0, 100});
  visit("threshold", o.threshold,
        OptionInfo{"springs are free where the field is weaker", "of its longest vector", 0, 1});
}

/// Stretch, shear and bend of the triangles (MOD-PLAIN, thesis 3.4.2).
struct PlainModel {
  static constexpr std::string_view name = "plain";
  double stretch = 10, stretch_damping = 1;
  double shear = 1, shear_damping = 0.1;
  double bend = 10, bend_damping = 1;
  double rest_scale = 0.67;
  double area_unit_mm2 = 0;
};
void describe(auto& visit, PlainModel& o) {
  visit("stretch", o.stretch, OptionInfo{"stiffness against stretching", "kg mm2/s2", 0, 1e9});
  visit("stretch_damping", o.stretch_damping, OptionInfo{"damping of stretching", "kg mm2/s", 0, 1e9});
  visit("shear", o.shear, OptionInfo{"stiffness against shearing", "kg mm2/s2", 0, 1e9});
  visit("shear_damping", o.shear_damping, OptionInfo{"damping of shearing", "kg mm2/s", 0, 1e9});
  visit("bend", o.bend, OptionInfo{"stiffness against bending", "kg mm2/s2", 0, 1e9});
  visit("bend_damping", o.bend_damping, OptionInfo{"damping of bending", "kg mm2/s", 0, 1e9});
  visit("rest_scale", o.rest_scale,
        OptionInfo{"lengths at rest, of those in the start mesh; 0.67 is the size of the data in a start placed at 1.5",
                   "", 0, 100});
  visit("area_unit_mm2", o.area_unit_mm2,
        OptionInfo{"what areas are counted in; 0: the mean triangle of the start mesh", "mm2", 0, 1e9});
}

/// The internal force of the discrete contour, carried to surfaces (FUT-3DCONTOUR, thesis 7.3; see
/// `surface_curvature_force`): bumps are drawn back, and a sphere of any size feels nothing.
struct CurvatureModel {
  static constexpr std::string_view name = "curvature";
  double strength = 1;
};
void describe(auto& visit, CurvatureModel& o) {
  visit("strength", o.strength,
        OptionInfo{"force on a vertex whose curvature differs from its neighbours' by one over the edges' length",
                   "N mm", 0, 1e9});
}

/// One of the models.
using ModelOptions = std::variant<FreeModel, SpringModel, RestrictedSpringModel, PlainModel, CurvatureModel>;

/// `asked`, or what suits the model: RK4 for the free one, backward Euler for the others, which are stiff wherever
/// triangles shrink. The thesis (4.4.2) takes RK4 for springs, too; damped as they are here, its stable step is a
/// hundredth of what the motion needs.
SolverOptions solver_for(const ModelOptions& model, const SolverOptions& asked);

/// The internal forces of a model at rest in `start`; none for the free one. `field` must outlive them.
std::vector<Force> internal_forces(const ModelOptions& model, const TriMesh& start, field::FieldView field,
                                   field::Sampling sampling = field::Sampling::nearest);

}  // namespace dynasurf::dynamics
