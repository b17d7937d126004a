#pragma once
#include "dynasurf/cloud/detail/orient.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// An open surface that was closed, and points on what closes it.
struct ClosedSurface {
  TriMesh mesh;
  OrientedPoints added;  // the middle of every new triangle
};

/// Closes every loop of an open surface by the surface of least area, see `make_flat_lid`. The lids may cross the
/// surface and each other.
ClosedSurface with_flat_lids(const TriMesh& open);

}  // namespace dynasurf::cloud
