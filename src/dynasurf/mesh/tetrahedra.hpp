#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::mesh {

/// A solid: vertices (mm) and tetrahedra whose first three corners run counter-clockwise seen from the fourth: the
/// determinant (b - a, c - a, d - a) is positive (VTK's, gmsh's and Abaqus's order).
struct TetMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
};

/// The space between two surfaces with the same triangles (FUT-TETRA, thesis 5.2): the prism over each triangle in
/// `layers` slabs of three tetrahedra. The sides of prisms are cut from their lower-numbered vertex, so neighbours fit
/// and the volumes of closed surfaces add up to outer less inner exactly. Vertices: those of the inner surface, then
/// slab by slab outwards. Open surfaces (sheets) give the solid between them. Tetrahedra of surfaces that cross come
/// out negative: `tet_quality` counts them. Throws InputError when the triangles differ or a layer count below 1.
TetMesh fill_between(const TriMesh& inner, const TriMesh& outer, int layers = 1);

/// Sum of signed volumes, mm3.
double volume_mm3(const TetMesh& solid);

/// How well shaped tetrahedra are.
struct TetQuality {
  std::size_t count = 0, not_positive = 0;
  double volume_min = 0, volume_max = 0, volume_mean = 0;  // mm3
  double shape_min = 0,
         shape_mean = 0;  // mean ratio 12 (3 V)^(2/3) / sum of squared edges: 1 regular, 0 flat or inverted
};
/// Measures all tetrahedra of a solid.
TetQuality tet_quality(const TetMesh& solid);

/// The same solid with smaller tetrahedra where `marked` (numbers of tetrahedra) asks for them (FUT-VOLMODEL): each of
/// them is cut at its longest edge, and so are neighbours as far as it takes that no vertex lies in the middle of an
/// edge or face of another tetrahedron and that nobody is cut at a shorter edge before its longest (after Rivara 1984).
/// Vertices keep their numbers, new ones follow; the volume stays. Throws InputError for a number out of range.
TetMesh refined(const TetMesh& solid, std::span<const std::uint32_t> marked);

/// How places move with a coarse solid around them, the cage: linearly within each tetrahedron, beyond the solid as the
/// nearest one goes on (FUT-VOLMODEL: a coarse model drives a fine wall). `moved` is the displacement of each vertex of
/// the cage. A linear motion is met exactly. Throws InputError for a cage without tetrahedra or another number of
/// moves.
std::vector<Vec3> carried(const TetMesh& cage, std::span<const Vec3> moved, std::span<const Vec3> places);

/// An isotropic material for small deformations. Units: mm, N, MPa (N/mm2). Muscle is far from linear; these defaults
/// are of the order of passive myocardium and nearly incompressible, as far as linear tetrahedra bear it.
struct Elasticity {
  double young_mpa = 0.02;
  double poisson = 0.45;  // from 0 to below 0.5
};

/// A vertex whose displacement is given, mm.
struct HeldVertex {
  std::uint32_t vertex = 0;
  Vec3 displacement{0, 0, 0};
};
/// A force on a vertex, N.
struct VertexForce {
  std::uint32_t vertex = 0;
  Vec3 force{0, 0, 0};
};

/// Displacement of every vertex at rest under forces (FUT-VOLMODEL, thesis 6.1.6.2): linear elasticity on linear
/// tetrahedra, one sparse Cholesky factorisation. Held vertices take their displacements exactly.
/// Throws InputError for a tetrahedron that is not positive, a vertex out of range or held twice, a material out of
/// range, or when what is held does not keep the solid from moving freely.
std::vector<Vec3> solve_elastic(const TetMesh& solid, const Elasticity& material, std::span<const HeldVertex> held,
                                std::span<const VertexForce> forces);

}  // namespace dynasurf::mesh
