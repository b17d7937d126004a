#pragma once
#include <span>
#include <vector>

#include "dynasurf/cloud/detail/feet.hpp"

namespace dynasurf::cloud {

/// A sample of a surface that no point faces.
struct UnfacedPlace {
  Vec3 place, normal;
  float confidence = 0;  // how far a point supports the surface over the distance of one that faces the same way
};

/// The parts of a surface that ought to hold points of their own and have none.
struct UnfacedParts {
  /// From how many points on their absence is no chance; right results of the bank (experiments/cloud_bank) stay below.
  static constexpr double fewest_points = 10;
  double points = 0;                 // that the largest part ought to hold, as the points around it lie
  std::vector<UnfacedPlace> places;  // spread evenly over the parts that ought to hold `fewest_points`
  double around = 0;                 // each place stands for the surface as near as this
};

/// Points support the surface that faces as it does where they meet it. Where a limb or a rim is cut off, the surface
/// that closes it lies near the points beside it, but none of them faces its way: within 60 degrees, and within three
/// spacings and noises beyond the nearest foot, so that a hole in a smooth surface does not count. Where points lie
/// farther apart that is up to four spacings for one. `spacing` and `noise` are those of the points whose feet these
/// are. The same for any number of threads.
UnfacedParts unfaced_parts(const TriMesh& mesh, std::span<const Foot> feet, double spacing, double noise);

/// Lowers the confidence at the vertices of a level of detail that lie at unfaced places and face as they do.
void doubt_unfaced(const UnfacedParts& parts, const TriMesh& mesh, std::span<float> confidence);

}  // namespace dynasurf::cloud
