#pragma once
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::mesh {

/// Signed volume in mm3 by Gauss's theorem as a sum of tetrahedra (GEO-VOLUME, thesis 5.6). Positive when the
/// triangles of a closed mesh are counter-clockwise seen from outside; independent of the origin for closed meshes.
double volume_mm3(const TriMesh& mesh);
/// The same by the thesis's quadrature (eq. 5.10): equal to rounding.
double volume_mm3_quadrature(const TriMesh& mesh);
double area_mm2(const TriMesh& mesh);

/// GEO-DEGEN (thesis 5.2): areas, d = area / longest edge (mm), and the scale-free shape 4 sqrt(3) A / sum of squared
/// edges (1 for an equilateral triangle, 0 for a degenerate one).
struct TriangleQuality {
  double area_mean = 0, area_min = 0, area_max = 0;
  double d_mean = 0, d_min = 0, d_max = 0;
  double shape_mean = 0, shape_min = 0;
  double smallest_angle_deg = 0;
};
/// How well shaped the triangles of a mesh are.
TriangleQuality triangle_quality(const TriMesh& mesh);

/// What a mesh is as a surface. A vertex of no triangle is a component of its own.
struct Topology {
  std::size_t vertices = 0, edges = 0, triangles = 0;
  std::size_t boundary_edges = 0, non_manifold_edges = 0, misoriented_edges = 0;
  int components = 0;
  long euler = 0;  // V - E + F
  bool closed() const { return boundary_edges == 0 && non_manifold_edges == 0; }
  bool oriented() const { return misoriented_edges == 0; }
};
/// Counts edges, components and holes of a mesh.
Topology topology(const TriMesh& mesh);

/// Distance of every vertex (grid frame) to the nearest centre of a non-zero voxel of `border`, in voxels: differences
/// divided by the spacing, Euclidean (MEAS-DIST, O14). Empty border: infinity everywhere.
std::vector<double> distances_to_border_voxels(const TriMesh& mesh, const Image& border);
/// The same in mm.
std::vector<double> distances_to_border_mm(const TriMesh& mesh, const Image& border);

/// In voxels, positive outside the solid that the border encloses and negative inside it (MEAS-DIST, fig 4.12).
std::vector<double> signed_distances_to_border_voxels(const TriMesh& mesh, const Image& border);

/// The other way round: the share of the non-zero voxels of `border` whose centre has a point of the surface nearer
/// than `reach_voxels`. A surface that lies on a part of its border only has all its vertices near it, and a low share.
/// 1 for an empty border.
double share_of_border_reached(const TriMesh& mesh, const Image& border, double reach_voxels = 1);

/// The polygons in which a plane (point, normal of any length but 0) cuts the mesh. A closed polygon repeats its first
/// point at its end; all are closed when the mesh is closed and oriented. Outer surfaces give polygons that run
/// counter-clockwise seen from the tip of the normal. A vertex on the plane counts as above it.
std::vector<std::vector<Vec3>> cross_section(const TriMesh& mesh, const Vec3& point, const Vec3& normal);

}  // namespace dynasurf::mesh
