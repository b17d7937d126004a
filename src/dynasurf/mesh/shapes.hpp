#pragma once
#include <span>
#include <string_view>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::mesh {

/// Unit icosphere: 10*4^level+2 vertices, 20*4^level triangles; level 2, 3, 4 are the thesis's 162, 642, 2562
/// (GEO-SPHERE, thesis 5.2). The vertices of level n are the first ones of level n+1. Throws OptionError unless the
/// level is 0 to 9.
TriMesh icosphere(int level);

/// The surface of the cube [-1, 1]^3 with `cells` x `cells` squares of two triangles on each side: 6 cells^2 + 2
/// vertices (the thesis's other start, 6.1.1). Throws OptionError unless `cells` is 1 to 1000.
TriMesh cube_surface(int cells);

/// What surfaces start from.
enum class StartShape { ellipsoid, sphere, cube, hull, marching_cubes, discretised_cubes, radial, file };
std::span<const std::string_view> names_of(StartShape);

/// Which way surfaces evolve (GEO-OUTIN, thesis 5.3).
enum class Direction { out_to_in, in_to_out };
std::span<const std::string_view> names_of(Direction);

/// GEO-PLACE (thesis 5.2).
struct Placement {
  StartShape shape = StartShape::ellipsoid;
  Direction direction = Direction::out_to_in;
  double scale = 1.5;
  double inside_scale = 0.6;
  bool centre_of_mass = false;
};
void describe(auto& visit, Placement& o) {
  visit(
      "shape", o.shape,
      OptionInfo{"ellipsoid or cube fitted to the data's box, sphere around it, the data's convex hull, the data's own "
                 "surface by marching cubes or by discretised marching cubes, radial: as far in every direction as the "
                 "border lies, or a mesh that is given, fitted to the box"});
  visit("direction", o.direction, OptionInfo{"from outside onto the border (thesis's choice, 5.3), or from inside"});
  visit("scale", o.scale,
        OptionInfo{
            "half axes of the start, in half sides of the data's bounding box; 1.74 holds the whole box; of a hull, "
            "in its own size; of a radial one, in its distances",
            "", 0.05, 10});
  visit("inside_scale", o.inside_scale, OptionInfo{"the same for starts that grow from inside", "", 0.01, 1});
  visit("centre_of_mass", o.centre_of_mass, OptionInfo{"centre on the data's centre of mass instead of the box"});
}

/// `unit` stretched around the non-zero voxels of `data`, in the grid frame: per axis, or for a sphere by its largest
/// half side. The box holds whole voxels, not only their centres; the centre of mass counts every non-zero voxel once.
/// Precondition: `data` has a non-zero voxel; throws InputError otherwise.
TriMesh place(const TriMesh& unit, const Image& data, const Placement& options);

/// The start that `options` ask for. Spheres, cubes and hulls have about 10 * 4^level vertices. Marching cubes runs
/// around the solid that the border encloses, so the number of its triangles follows the data, and direction and scales
/// do not apply; discretised marching cubes likewise. A radial start has the vertices of a sphere, each moved along its
/// ray from the middle of the box to the border, times the scale. `given` is the mesh of StartShape::file, any size and
/// place: its bounding box is fitted. Throws like `place`, and OptionError when no mesh was given or it has no extent.
TriMesh start_mesh(const Image& border, int level, const Placement& options, const TriMesh* given = nullptr);

/// 1 in the non-zero voxels of a border and where they close a ring around a voxel in its slice across any axis, so
/// that a hole in a wall does not empty the whole; else 0.
Image enclosed_solid(const Image& border);

}  // namespace dynasurf::mesh
