#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/mesh/detail/ray_bvh.hpp"
#include "dynasurf/ventricle/measures/detail/heart_axes.hpp"

namespace dynasurf::ventricle {

/// How a vertex came to its thickness.
enum class ThicknessSource : std::uint8_t {
  ray,       // along its normal to the other surface
  nearest,   // its ray met nothing within reach: distance to the nearest point of the other surface
  crossing,  // the surfaces cross there: the endocardial vertex lies outside, the distance is negative
  lid        // not wall: on the lid that closes the surface at the base, or within `lid_mm` of it; thickness 0
};

/// The thickness at every vertex of a surface, and where it comes from.
struct VertexThickness {
  std::vector<double> mm;
  std::vector<ThicknessSource> source;
};

/// Over the wall of one gate, weighted by area, from both surfaces. Vertices without a ray are not in it.
struct ThicknessSummary {
  double mean_mm = 0, sd_mm = 0, min_mm = 0, max_mm = 0;
  double from_endo_mm = 0, from_epi_mm = 0;  // means of the two directions
  int nearest = 0, crossing = 0;             // flagged vertices of both surfaces
};

/// The thickness at all vertices of both surfaces.
struct WallThickness {
  VertexThickness endo, epi;
  std::optional<ThicknessSummary> summary;  // absent when no ray met the other surface
};

/// Wall thickness by rays (CARD-THICK, thesis appendix C): from every endocardial vertex along its outward normal to
/// the epicardium, and from every epicardial vertex inwards to the endocardium, with a bounding-box tree. Normals leave
/// the triangles of the lid out. Between edges of a blurred image it is an apparent thickness: mostly that of the
/// camera. World frame, closed surfaces, counter-clockwise triangles. A ray that leaves through the lid, or is longer
/// than `reach_mm`, counts as none.
WallThickness wall_thickness(const mesh::TracedSurface& endo, const mesh::TracedSurface& epi, const HeartAxes& axes,
                             double lid_mm = 2, double reach_mm = 30);

}  // namespace dynasurf::ventricle
