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
  BoundaryRule boundary = BoundaryRule::close;  // not `trim`, which fills nothing
};

/// Points that close what a scan left open.
struct HoleFill {
  OrientedPoints points;
  std::size_t on_tubes = 0;  // the first of the points: those on tubes
  int holes = 0;             // closed each by a piece of its own
  int joined = 0;            // pairs between which a tube was put
  BodyTopology kind;         // of the surface when it is closed like that
  // What the held surface faces, added up, over its area: near 0 for a closed body, half for half a sphere, 1 for a
  // plane.
  double one_way = 0;
  bool is_open = false;  // the rims of the surface were left open; `joined` and `kind` then say nothing
};

/// From this `one_way` on `BoundaryRule::automatic` leaves rims open: a sphere of which 45 % are left reaches it.
inline constexpr double open_from = 0.45;

/// Looks on the surface of `field`, which comes from the points, for pieces that the points do not hold, and puts
/// points where the body most likely goes on there: every hole gets a smooth piece of its own, or a tube between two
/// holes that face each other, where that has to bend less. So the ends of a torn handle meet again, and both sides of
/// a torn wall are mended apart, which a function fitted to the points alone gets wrong. Handles that a level a little
/// higher or lower does not have are accidents. Where rims are to be left open, only the loops of every piece that are
/// less than half as long as its longest get their pieces. Nothing where there are no holes.
std::optional<HoleFill> fill_holes(const IndicatorField& field, const OrientedPoints& points, const Holes& options);

}  // namespace dynasurf::cloud
