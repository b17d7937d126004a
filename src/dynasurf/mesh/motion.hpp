#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// linear: C0. catmull_rom: C1, each gate's velocity is that between its neighbours. periodic_cubic: C2 through the
/// gates. b_spline: C2 and never outside the gates' hull, but smoothed: it passes near the gates, not through them.
enum class TimeInterpolation { linear, periodic_cubic, catmull_rom, b_spline };
std::span<const std::string_view> names_of(TimeInterpolation);

/// GEO-KEYFRAME (thesis 5.7) and FUT-SPLINE.
struct Keyframes {
  TimeInterpolation interpolation = TimeInterpolation::periodic_cubic;
  int frames_between = 0;
};
void describe(auto& visit, Keyframes& o) {
  visit("interpolation", o.interpolation,
        OptionInfo{
            "linear (thesis 5.7); periodic_cubic: C2 through the gates; catmull_rom: C1 through the gates; b_spline: "
            "C2, smoothed; all close from the last gate to the first"});
  visit("frames_between", o.frames_between,
        OptionInfo{"meshes written between two gates (thesis: 20-30); 0 writes none", "", 0, 1000});
}

/// The mesh at `phase` in [0, 1) of the cycle; mesh g of n sits at phase g/n, and the cycle closes.
/// Throws InputError unless all meshes share their triangles.
TriMesh at_phase(std::span<const TriMesh> cycle, double phase, TimeInterpolation how);

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
