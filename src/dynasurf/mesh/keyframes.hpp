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

}  // namespace dynasurf::mesh
