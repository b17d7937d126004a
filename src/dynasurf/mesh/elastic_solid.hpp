#pragma once
#include <span>
#include <vector>

#include "dynasurf/mesh/tetrahedra.hpp"

namespace dynasurf::mesh {

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
