#pragma once
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/heart/locate.hpp"
#include "dynasurf/image/edges.hpp"
#include "dynasurf/ventricle/detail/orientation.hpp"
#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::ventricle {

/// Throws OptionError when what a person says cannot be of this study: a centre outside the volume as it was stored
/// (`original`), slices or a valve plane outside the short-axis stack (`study`), a last slice before the first.
void require_inside(const UserOverrides& manual, const Study& original, const Study& study);

/// The coarse circle (CIRC-COARSE) around a heart that was found: centre where its axis crosses the middle of the
/// heart, radius that of the wall's middle and `room_mm` more. What `asked` sets stays. Without a heart the centre is
/// the one a person has set, if any.
CoarseCircle circle_around(const Study& study, const std::optional<heart::Location>& heart, const UserOverrides& manual,
                           CoarseCircle asked);

/// Where the heart that was found has the end of its cavity, as a slice (0: middle of the lowest). Absent without a
/// heart whose wall was clearly seen, or one that stands on its head in the stack.
std::optional<double> expected_cavity_end(const Study& study, const std::optional<heart::Location>& heart);

/// A plane square to the stack (world frame), so many mm over the middle of its first slice.
heart::BasePlane level_plane(const Grid& grid, double height_mm);

/// The valve plane of every gate (world frame), smooth over the cycle, or where a person has set or moved it. Absent
/// for all gates where no heart was found or less than half of the gates show one ("base.plane_missing"); gates that
/// did not fit in and follow the others are named in "base.gate_follows".
std::vector<std::optional<heart::BasePlane>> valve_planes(const Study& study,
                                                          const std::optional<heart::Location>& heart,
                                                          const UserOverrides& manual, Notes& notes);

/// First and last slice that cut the ventricle, 0-based (FUT-USEFULSLICES): from the outer apex to the highest valve
/// plane, or what a person has set. The whole stack where neither is known.
struct SliceRange {
  int first = 0, last = 0;
};
SliceRange useful_slices(const Study& study, const std::optional<heart::Location>& heart,
                         const std::vector<std::optional<heart::BasePlane>>& planes, const UserOverrides& manual);

/// How well a slice shows a wall, 0 to 1: the share of directions around the circle's centre with an edge inside the
/// circle, times the roundness of the outermost edges, times the brightness of the wall against half that of the best
/// slice (at most 1).
std::vector<double> slice_scores(const Image& image, const Mask& edges, const CoarseCircle& coarse);

/// The longest run of slices whose score reaches `least`; the first of equal ones. Absent where none does.
std::optional<SliceRange> longest_run(std::span<const double> scores, double least = 0.35);

/// First and last slice by `slice_scores` of the mean of the gates, or what a person has set; the whole stack where no
/// slice is good.
SliceRange scored_slices(const Study& study, const image::EdgeOptions& edges, const CoarseCircle& coarse,
                         const UserOverrides& manual);

/// Edges of slices outside the range are no border of the ventricle.
void clear_outside(Mask& edges, const SliceRange& range);

}  // namespace dynasurf::ventricle
