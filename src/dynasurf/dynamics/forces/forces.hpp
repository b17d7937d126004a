#pragma once
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/dynamics/particles.hpp"
#include "dynasurf/field/detail/field_view.hpp"

namespace dynasurf::dynamics {

// The forces of the thesis (chapter 3), each in its own source beside this header. All of them keep what they need by
// value, except fields and volumes, which must outlive them. On degenerate triangles and edges (zero area or length)
// they do nothing.

/// Resists stretching and squeezing of each triangle against its shape in `rest` (INT-STRETCH, thesis 3.4-3.7):
/// C = a (|Wu| - b, |Wv| - b) with material coordinates laid flat in the triangle at rest, its first edge along u.
struct StretchForce {
  double stiffness = 10, damping = 1;
  double rest_scale = 1;  // b: the lengths wanted, in those of `rest`
  /// What the material area a is counted in; 0: the mean triangle of `rest`. The thesis names no unit. With 1 mm2 the
  /// force grows with the cube of the triangles' sides, and no published stiffness lets a sphere follow a field.
  double area_unit_mm2 = 0;
};
/// The force of stretching on the vertices of a mesh like `rest`.
Force stretch_force(const TriMesh& rest, const StretchForce& options);

/// Resists shearing of each triangle (INT-SHEAR, thesis 3.8): C = a Wu . Wv.
struct ShearForce {
  double stiffness = 1, damping = 0.1;
  double area_unit_mm2 = 0;  // as in StretchForce
};
/// The force of shearing, likewise.
Force shear_force(const TriMesh& rest, const ShearForce& options);

/// Keeps the angle between the normals of two triangles at their common edge (INT-BEND, thesis 3.9): C = theta - rest,
/// positive on convex edges. Edges of one triangle, or of more than two, do not bend.
enum class BendRest { initial, flat, zone };
struct BendForce {
  double stiffness = 10, damping = 1;
  BendRest rest = BendRest::initial;  // initial: the angle in `rest`; flat: none; zone: free inside the interval
  double zone_low_rad = 0, zone_high_rad = 0;  // of `zone`
};
/// The force of bending, likewise.
Force bend_force(const TriMesh& rest, const BendForce& options);

/// A spring between two particles (INT-SPRING, thesis 3.56).
struct Spring {
  std::uint32_t a = 0, b = 0;
  double rest_mm = 0;
};
/// The edges of a mesh, each once, with `rest_scale` times their length as length at rest.
std::vector<Spring> springs_of(const TriMesh& mesh, double rest_scale = 1);

/// How stiff and how damped springs are, kg/s2 and kg/s.
struct SpringForce {
  double stiffness = 10, damping = 1;
};
/// The force of springs on their ends (eq. 3.56).
Force spring_force(std::vector<Spring> springs, const SpringForce& options);

/// Springs that leave the direction of the field to the field (INT-RSPRING, thesis 3.4.4, eqs 5.4-5.5; E43): at each
/// end, the part of the spring's force along V(x) is taken away where |V(x)| > threshold. Momentum is not conserved.
struct RestrictedSpringForce {
  double stiffness = 10, damping = 1;
  double threshold = 1e-3;  // of the longest vector of the field
  field::Sampling sampling = field::Sampling::nearest;
};
/// The force of such springs; the field must outlive it.
Force restricted_spring_force(std::vector<Spring> springs, field::FieldView field,
                              const RestrictedSpringForce& options);

/// The pull of a field: F = strength * V(x) (thesis 3.4). Implicit solvers take it as constant within a step.
Force field_pull(field::FieldView field, double strength, field::Sampling sampling = field::Sampling::nearest);

/// F = -drag * v, and with a volume F = -drag(x) * v, read at the nearest voxel (VOL-DAMP).
Force drag_force(double drag_kg_s);
Force drag_force(const Image& drag_kg_s);

/// The value of a map at the nearest voxel; also for points outside the grid, or nowhere.
double drag_at(const Image& drag_kg_s, const Vec3& grid_mm);

/// F = m g; `masses` as in the system. g in mm/s2, 9810 downwards on earth.
Force gravity_force(std::vector<double> masses, const Vec3& g_mm_s2 = {0, 0, -9810});

}  // namespace dynasurf::dynamics
