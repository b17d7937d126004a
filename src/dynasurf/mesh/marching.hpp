#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::mesh {

/// What lies beyond the grid: nothing, so that every surface is closed half a voxel outside, or the unknown, so that
/// surfaces end at the outermost voxel centres.
enum class GridEdge { closed, open };

/// Surface of the voxels at or above `level`, in the grid frame, counter-clockwise seen from below the level (GEO-MC,
/// thesis 5.4): linear along the lattice's edges, one vertex per edge that it crosses. The saddle of each face decides
/// whether its two corners above the level are joined (asymptotic decider of Nielson and Hamann), so neighbouring cells
/// agree. Always oriented and manifold, and with GridEdge::closed also without boundary. Vertices keep a thousandth of
/// an edge away from voxel centres, so no triangle is flat, also where a value equals the level. Empty when no value
/// reaches the level. Throws InputError for a level or a value that is not finite.
TriMesh marching_cubes(const Image& image, double level, GridEdge edge = GridEdge::closed);

/// Whether what lies in one plane is cut into as few triangles as are found, or left as the cells gave it.
enum class Facets { merged, as_found };

/// Discretised marching cubes (GEO-DMC, thesis 5.4; Montani, Scateni, Scopigno 1994): the same surface with its
/// vertices in the middles of the lattice's edges, so that it lies in few planes (their normals have only -1, 0 and 1
/// as components, but for the rare cell whose loop no such triangles fill), and triangles of one plane can be merged
/// without moving the surface. Closed, oriented and manifold as `marching_cubes`, coarser by half a voxel and steep
/// where that is smooth; the level decides sides only. Throws likewise.
TriMesh discretised_marching_cubes(const Image& image, double level, Facets facets = Facets::merged);

/// How a face with two corners above the level on one diagonal and two below on the other is read.
enum class Saddle { joined, separated, asymptotic };
std::span<const std::string_view> names_of(Saddle);

/// Line of marching squares: points in mm in the slice's plane. A closed line repeats its first point at its end. What
/// is above the level lies to its left, with x to the right and y up.
using IsoLine = std::vector<Eigen::Vector2d>;

/// The level's lines in slice k, each whole (marching squares, thesis fig 5.6). Lines end at the outermost voxel
/// centres. Vertices as for `marching_cubes`. Throws InputError for a slice out of range, or a level or value that is
/// not finite.
std::vector<IsoLine> marching_squares(const Image& image, int k, double level, Saddle saddle = Saddle::asymptotic);

/// Part of each voxel (0..1) inside a closed, oriented mesh given in the grid frame: exact but for rounding, whatever
/// the size of triangles and voxels, so the parts of a mesh inside the grid add up to its volume. Where the mesh cuts
/// itself a part counts as often as the surface winds around it, at most once. Throws InputError when the mesh is open
/// or its triangles do not all face the same way.
Image voxel_parts(const Grid& grid, const TriMesh& mesh);

}  // namespace dynasurf::mesh
