#pragma once
#include "dynasurf/cloud/options.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// A sphere, ellipsoid or hull around every part of a closed surface, drawn onto it: its particles follow the steady
/// gradient vector flow of the part's voxels until they meet one (thesis 6.2), coarse first, with triangles evened out
/// on the way, and moves that would make the surface meet itself taken back. So every part is a ball without handles,
/// free of self-intersections, and near `target` where the field leads: deep narrow cavities may stay shallow.
/// Precondition: `start` is one of the three. Throws Cancelled.
TriMesh deform_start(const TriMesh& target, CloudStart start, const Progress& progress = {});

}  // namespace dynasurf::cloud
