#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/contour.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// Closed contours, one above the other: columns and rows of the points in mm, heights in mm, rising.
struct ContourStack {
  std::vector<Contour> contours;
  std::vector<double> z_mm;
};

/// How two neighbouring contours are joined (C3D-TESS): `even` gives all of them the same number of points and cuts
/// each quad along its shorter diagonal; `greedy` gives each as many as its length asks for and always takes the
/// shorter of the two edges that go on.
enum class Strip { even, greedy };
std::span<const std::string_view> names_of(Strip);

/// C3D-TESS and C3D-CAP (thesis 6.1.6.1).
struct Tessellation {
  int points = 64;
  Strip strip = Strip::even;
};
void describe(auto& visit, Tessellation& o) {
  visit("points", o.points,
        OptionInfo{"points of a contour (strip even), or of the longest one (greedy)", "", 8, 4096});
  visit("strip", o.strip, OptionInfo{"even: equal counts, shorter diagonal; greedy: counts by length"});
}

/// How far the middle of the lowest and of the highest contour's cap lies outside; 0 is flat.
struct CapHeights {
  double below_mm = 0, above_mm = 0;
};

/// The contours as rings of a closed mesh: same orientation, started at the same direction from the mean of all
/// centroids, joined by strips, closed by fans to the centroids of the first and the last one. Normals point outwards.
/// Throws InputError for fewer than two contours, heights that do not rise, or an open contour.
TriMesh tessellate(const ContourStack& stack, const Tessellation& options, const CapHeights& caps = {});

/// Three ways to the volume of such a mesh (C3D-VOL, thesis 6.1.6.1). All are in mm3.
struct StackVolumes {
  double trapezoid = 0;       // thesis: area of the upper contour x thickness, plus the projected area of each lateral
                              // triangle x thickness / 2: the mean of both areas, 0.5 (A0 + A1) t
  double gauss = 0;           // Gauss's theorem on the closed mesh
  double triangle_exact = 0;  // as the thesis, but each triangle at its mean height: equals gauss
};
/// The volumes of the mesh that `tessellate` makes of the stack.
StackVolumes volumes_of(const ContourStack& stack, const Tessellation& options, const CapHeights& caps = {});

}  // namespace dynasurf::mesh
