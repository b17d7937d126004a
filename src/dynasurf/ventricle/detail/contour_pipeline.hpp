#pragma once
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/contour.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/dynamics/contour/contours.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/mesh/contour_stack.hpp"
#include "dynasurf/mesh/smooth.hpp"
#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::ventricle {

/// What pulls the contours: the gradient of the border strength (FLD-POT); its gradient vector flow in the plane, which
/// reaches farther but is drawn towards the inside of a bend; or first the flow and then the gradient.
enum class ContourForce { potential, flow, both };
std::span<const std::string_view> names_of(ContourForce);

/// Where the surfaces end (C3D-CAP). `slice_centre`: flat, in the outermost slices (thesis). `slice_face`: the top on
/// the upper face of the highest slice, where the muscle ends; the bottom as a dome of half a slice.
enum class StackEnds { slice_centre, slice_face };
std::span<const std::string_view> names_of(StackEnds);

/// PIPE-4 (C3D-*, thesis 6.1.6.1): a contour in every slice, each started from that of the slice before.
struct ContourPipeline {
  double sigma_px = 1;
  ContourForce force = ContourForce::both;
  double mu = 0.02;
  dynamics::DiscreteContour model;
  std::optional<int> best_slice;
  double jump = 0.3;
  double least_area_px2 = 3;
  mesh::Tessellation tessellation;
  StackEnds ends = StackEnds::slice_centre;
  mesh::Smoothing smooth{.sweeps = 0};
};
void describe(auto& visit, ContourPipeline& o) {
  visit("sigma_px", o.sigma_px, OptionInfo{"Gaussian before the gradient", "px", 0, 20});
  visit("force", o.force,
        OptionInfo{
            "potential: gradient of the border strength; flow: its gradient vector flow; both: flow, then potential"});
  visit("mu", o.mu, OptionInfo{"balance of the flow", "", 1e-6, 1e4});
  visit("model", o.model, OptionInfo{"the discrete contour"});
  visit("best_slice", o.best_slice,
        OptionInfo{"slice to begin with, from 1 at the apex; unset: where the border is strongest along its contour",
                   "", 1, 100000});
  visit("jump", o.jump,
        OptionInfo{
            "a contour whose area leaves that of its neighbour, and the line through two, by more is replaced by the "
            "neighbour's",
            "of the area", 0, 10});
  visit("least_area_px2", o.least_area_px2, OptionInfo{"a smaller contour ends the sweep", "px2", 0, 1e6});
  visit("tessellation", o.tessellation, OptionInfo{"the mesh between the contours"});
  visit("ends", o.ends, OptionInfo{"slice_centre (thesis) or slice_face"});
  visit("smooth", o.smooth, OptionInfo{"smoothing of the finished mesh; 0 sweeps: none"});
}

/// The contours of one wall in one gate, px, per slice of the stack from the apex; absent where there is none.
struct WallContours {
  std::vector<std::optional<Contour>> slices;
  std::vector<std::vector<Vec2>> pulls;  // of the field on the points of each, its largest vector is 1
  std::vector<std::vector<Vec2>> bends;  // their curvature forces, px
  int best_slice = -1;
  int at_rest = 0, found = 0;  // how many contours there are and how many of them came to rest
  int steps = 0;               // of all contours
  Notes notes;                 // "contour.jump", "contour.none", "contour.best_slice"
};

/// C3D-PROP: the contour of the best slice from the automatic circle, then slice by slice up and down, each from the
/// one before. The border strength of a wall is the slope along the ray from the axis of the ventricle: falling
/// outwards for the outer wall, rising for the inner one, inside the automatic circle. The outer wall begins in the
/// lowest slice with an outer border, the inner one above the division slice; both end in `base_slice`. `outer`, when
/// given, bounds the search of the inner wall. A best slice that is asked for is moved, with a note, to the nearest one
/// of these; throws OptionError when the stack has no such slice.
WallContours propagate_contours(const Image& image, const Labels& labels, Border wall, int base_slice,
                                const ContourPipeline& options, const WallContours* outer = nullptr);

/// C3D-TESS, C3D-CAP, C3D-SMOOTH, C3D-VOL. The mesh is in the grid frame. Empty for fewer than two contours.
struct ContourSurface {
  dynamics::EvolutionResult evolved;  // the mesh; the share of contours at rest as `stopped_fraction`
  mesh::StackVolumes volumes;         // before smoothing, mm3
};
/// Makes a surface of the contours of one wall.
std::optional<ContourSurface> contour_surface(const WallContours& contours, const Grid& grid,
                                              const ContourPipeline& options);

}  // namespace dynasurf::ventricle
