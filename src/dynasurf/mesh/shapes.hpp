#pragma once
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf {

/// Unit icosphere: 10*4^level+2 vertices, 20*4^level triangles; level 2, 3, 4 are the thesis's 162, 642, 2562
/// (GEO-SPHERE, thesis 5.2). The vertices of level n are the first ones of level n+1. Throws OptionError unless the
/// level is 0 to 9.
TriMesh icosphere(int level);

/// GEO-PLACE (thesis 5.2).
struct Placement {
  double scale = 1.5;
  bool centre_of_mass = false;
};
void describe(auto& visit, Placement& o) {
  visit("scale", o.scale,
        Field{"half axes of the ellipsoid, in half sides of the data's bounding box; 1.74 holds the whole box", "",
              0.05, 10});
  visit("centre_of_mass", o.centre_of_mass, Field{"centre on the data's centre of mass instead of the box"});
}

/// `unit` stretched to an ellipsoid around the non-zero voxels of `data`, in the grid frame. The box holds whole
/// voxels, not only their centres; the centre of mass counts every non-zero voxel once.
/// Precondition: `data` has a non-zero voxel; throws InputError otherwise.
TriMesh place(const TriMesh& unit, const Image& data, const Placement& options);

}  // namespace dynasurf
