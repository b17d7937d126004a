#pragma once
#include <optional>
#include <span>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/heart/detail/lv_shell.hpp"

namespace dynasurf::heart {

/// What is known of a heart beforehand, for example by hand. World frame (LPS, mm).
struct LocateHints {
  std::optional<Vec3> centre_mm;    // the heart's middle lies within 25 mm of this
  std::optional<Vec3> axis;         // from apex to base, any length but 0
  std::optional<double> radius_mm;  // to the middle of the wall
};

/// Where a left ventricle lies in a volume. World frame (LPS, mm).
struct Location {
  LvShell cup;
  double contrast = 0;               // of the wall against its sides, relative to the wall: 0 none, 1 perfect
  double ridge_share = 0;            // share of the directions in which the wall was seen as a ridge
  double spread_mm = 0;              // median distance of those points from the cup
  double runner_up = 0;              // score of the next best place relative to this one: near 1 is ambiguous
  std::optional<Vec3> runner_up_mm;  // middle of that place
  double outside = 0;                // share of the wall that lies outside the volume
  double other_end = 0;              // score with apex and base exchanged, relative to this one
  bool is_pointed_at = false;        // at a given centre, by a wall of which too little is seen
  std::optional<double> outward_mm;  // `outward_motion_mm` of the cup as its shape has it; absent: not looked at
  bool is_turned = false;            // clear the other way up, apex and base were exchanged against its shape

  /// Whether the wall was seen well enough to be believed. The limits are those of the flag "heart_uncertain".
  bool is_clear() const { return contrast >= 0.22 && ridge_share >= 0.55; }
  /// Whether it is taken for a heart.
  bool is_believed() const { return is_clear() || is_pointed_at || is_turned; }
};

/// The mean of the gates: what the eye sees of a beating heart at rest.
Image mean_image(std::span<const Image> gates);

/// Finds the ventricle in a volume of any orientation and field of view: hollow shells of all sizes and places are
/// tried on a coarse grid, the best places become cups (`local_search`) in 26 directions, and the best cup in which a
/// wall is clearly seen is fitted to its ridge (`fit_cup`). Where no wall is plainly seen, the volume is searched again
/// with its brightness cut, for what is hotter than the wall. Absent when nothing in the volume looks like a cup. An
/// axis that is given is kept as it is; a radius says where to start. Around a centre that is given, a cup is found
/// even where too little of its wall is seen, if it is hollow.
std::optional<Location> locate(const Image& mean, const LocateHints& hints = {});

}  // namespace dynasurf::heart
