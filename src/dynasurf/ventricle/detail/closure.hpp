#pragma once
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::ventricle {

/// How the open ends of the two borders are closed (VOL-COVER, thesis 6.1.2.1).
struct Closure {
  bool cover = true;
  bool valve_plane = true;
  double base_level = 0.5;
};
void describe(auto& visit, Closure& o) {
  visit("cover", o.cover,
        OptionInfo{"close both ends of each border with a disc of border voxels, so that surfaces stop there"});
  visit("valve_plane", o.valve_plane,
        OptionInfo{
            "end the surfaces at a plane fitted to the end of the wall, gate by gate; false, and where no plane is "
            "found: at the upper face of a slice"});
  visit("base_level", o.base_level,
        OptionInfo{"the heart ends in the highest slice whose wall is still this bright", "of the wall in the middle",
                   0.05, 1});
}

/// The highest slice that still belongs to the ventricle: going up from the middle of the labelled slices, the last
/// one whose wall (mean over directions of the brightest value on a ray inside the circle) reaches `base_level` of
/// the wall in the middle. Blur halves the brightness exactly at the end of the muscle, so the upper face of this
/// slice is the base plane, without bias, to half a slice. -1 when nothing is labelled.
int find_base_slice(const Image& image, const Labels& labels, double base_level, Notes& notes);

/// The slice whose cell holds the highest point of a plane (world frame) within `radius_mm` of where the axis meets it,
/// held inside the stack: a border closed there reaches above the plane everywhere.
int slice_above(const Grid& grid, const heart::BasePlane& plane, double radius_mm);

/// The border without what lies above `base_slice`, its upper end closed in that slice and its lower end in the
/// lowest slice that has border voxels, each by the disc inside the ring (of the nearest slices where the ring itself
/// has gaps). An empty border stays empty.
Image close_border(const Image& border, int base_slice);

/// The border on a grid that leaves at least `voxels` empty voxels around it on every side: a field needs room outside
/// a border to pull particles in, and a heart may be cut off by the edge of its image. World positions stay; an empty
/// border, or one that has the room already, is returned as it is.
Image with_room(Image border, int voxels);

/// The image on a larger grid of the same lattice (see `with_room`), its outermost voxels repeated.
Image spread_to(const Image& image, const Grid& grid);

}  // namespace dynasurf::ventricle
