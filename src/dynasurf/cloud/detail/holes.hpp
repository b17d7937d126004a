#pragma once
#include <optional>

#include "dynasurf/cloud/detail/body.hpp"
#include "dynasurf/cloud/detail/orient.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// How holes are found and filled; lengths are in the unit of the points.
struct Holes {
  double reach = 0;              // surface farther than this from all points that face the same way is made up
  double spacing = 0;            // of the points that are put there
  double smallest_share = 0.02;  // of the points: smaller parts of the surface are left out, see body_surface
  bool may_join = true;          // two holes of one part by a tube, which makes a handle
};

/// Points that close what a scan left open.
struct HoleFill {
  OrientedPoints points;
  int holes = 0;      // closed each by a piece of its own
  int joined = 0;     // pairs between which a tube was put
  BodyTopology kind;  // of the surface when it is closed like that
};

/// Looks on the surface of `field`, which comes from the points, for pieces that the points do not hold, and puts
/// points where the body most likely goes on there: every hole gets a smooth piece of its own, or a tube between two
/// holes that face each other, where that has to bend less. So the ends of a torn handle meet again, and both sides of
/// a torn wall are mended apart, which a function fitted to the points alone gets wrong. Handles that a level a little
/// higher or lower does not have are accidents. Nothing where there are no holes.
std::optional<HoleFill> fill_holes(const IndicatorField& field, const OrientedPoints& points, const Holes& options);

}  // namespace dynasurf::cloud
