#pragma once
#include "dynasurf/cloud/detail/indicator_field.hpp"
#include "dynasurf/cloud/detail/orient.hpp"
#include "dynasurf/cloud/detail/support.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// How an open surface is cut out of a closed one; lengths are in the unit of the points.
struct OpenCut {
  double reach = 0;              // surface farther than this from all points that do not face against it is made up
  double margin = 0;             // how far the surface goes on beyond the outermost points; less than the reach
  double smallest_share = 0.02;  // of the points: smaller pieces are left out
};

/// An open surface, and what it is.
struct OpenSurface {
  TriMesh mesh;  // manifold, oriented, in the cloud's frame
  int parts = 0, loops = 0;
  int genus = 0;  // of all parts, each loop closed by a disc
};

/// The surface of `field` where points are: all that lies farther from the points of the scan and of `fill` than the
/// reach is cut off, and along the cut as much again as the reach is wider than the margin, so that the loops run along
/// the outermost points and gaps narrower than twice the reach stay closed. Without loops where the points hold all of
/// the surface; empty where they hold none.
OpenSurface open_surface(const IndicatorField& field, const SupportingPoints& scan, const OrientedPoints& fill,
                         const OpenCut& cut);

}  // namespace dynasurf::cloud
