#pragma once
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// How a surface differs from itself at rest: per vertex of two meshes with the same triangles.
struct SurfaceMotion {
  std::vector<double> displacement_mm;
  std::vector<double> inward_mm;            // the part of it against the normal of the surface at rest
  std::vector<double> area_strain_percent;  // of the triangles around the vertex together; 0 where they had no area
};
/// Meaningful as far as vertices stay on their material: surfaces that were pulled onto edges slide along themselves.
/// Throws InputError when the triangles differ.
SurfaceMotion surface_motion(const TriMesh& rest, const TriMesh& now);

/// A mesh moved along with tracked points (FUT-TAGGED) by the spline that takes every point from `rest` to `now`. This
/// is how twist enters, which no surface shows by itself. `smoothing` (mm) lets noisy points be missed. Throws as
/// PointSpline does.
TriMesh move_with_points(TriMesh mesh, std::span<const Vec3> rest, std::span<const Vec3> now, double smoothing = 0);

/// Rotation (deg) about an axis (unit) through `on_axis` that takes vertices from `rest` to `now` best,
/// counter-clockwise seen from the axis's tip; over vertices with heights from `low` to `high` along the axis. 0 when
/// there are none. Twist is the difference between apex and base.
double rotation_deg(std::span<const Vec3> rest, std::span<const Vec3> now, const Vec3& on_axis, const Vec3& axis,
                    double low, double high);

}  // namespace dynasurf::mesh
