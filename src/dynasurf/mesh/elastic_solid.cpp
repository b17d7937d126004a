#include <string>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/tetrahedra.hpp"

namespace dynasurf::mesh {
namespace {

using Block = Eigen::Matrix<double, 12, 12>;

void check(const TetMesh& solid, const Elasticity& material, std::span<const HeldVertex> held,
           std::span<const VertexForce> forces) {
  if (!(material.young_mpa > 0)) throw InputError("solve_elastic: young_mpa is not positive");
  if (!(material.poisson >= 0 && material.poisson < 0.5))
    throw InputError("solve_elastic: poisson is " + std::to_string(material.poisson) + "; expected 0 to below 0.5");
  const auto in_range = [&](std::uint32_t v) {
    if (v >= solid.vertices.size()) throw InputError("solve_elastic: there is no vertex " + std::to_string(v));
  };
  std::vector<bool> is_held(solid.vertices.size(), false);
  for (const HeldVertex& h : held) {
    in_range(h.vertex);
    if (is_held[h.vertex]) throw InputError("solve_elastic: vertex " + std::to_string(h.vertex) + " is held twice");
    is_held[h.vertex] = true;
  }
  for (const VertexForce& f : forces) in_range(f.vertex);
}

/// Stiffness of one tetrahedron: volume * B' D B with constant gradients of the four corners' shares.
Block stiffness_of(const TetMesh& solid, std::size_t number, const Elasticity& material) {
  const auto& t = solid.tetrahedra[number];
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = solid.vertices[t[k + 1]] - solid.vertices[t[0]];
  const double volume = edges.determinant() / 6;
  if (!(volume > 0)) throw InputError("solve_elastic: tetrahedron " + std::to_string(number) + " is not positive");
  const Mat3 inverse = edges.inverse();
  Vec3 gradient[4];
  gradient[0] = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    gradient[k + 1] = inverse.row(k).transpose();
    gradient[0] -= gradient[k + 1];
  }
  const double nu = material.poisson;
  // Lame's constants.
  const double lambda = material.young_mpa * nu / ((1 + nu) * (1 - 2 * nu)), mu = material.young_mpa / (2 * (1 + nu));
  Block k;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const Vec3 &a = gradient[i], &b = gradient[j];
      k.block<3, 3>(3 * i, 3 * j) =
          volume * (lambda * a * b.transpose() + mu * b * a.transpose() + mu * a.dot(b) * Mat3::Identity());
    }
  return k;
}

}  // namespace

std::vector<Vec3> solve_elastic(const TetMesh& solid, const Elasticity& material, std::span<const HeldVertex> held,
                                std::span<const VertexForce> forces) {
  check(solid, material, held, forces);
  const std::size_t count = solid.vertices.size();
  std::vector<Vec3> moved(count, Vec3::Zero());
  std::vector<int> unknown(count, 0);  // place of a free vertex's first number, -1: held
  for (const HeldVertex& h : held) unknown[h.vertex] = -1, moved[h.vertex] = h.displacement;
  int unknowns = 0;
  for (int& u : unknown)
    if (u >= 0) u = unknowns, unknowns += 3;
  if (unknowns == 0) return moved;

  Eigen::VectorXd load = Eigen::VectorXd::Zero(unknowns);
  for (const VertexForce& f : forces)
    if (unknown[f.vertex] >= 0) load.segment<3>(unknown[f.vertex]) += f.force;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(solid.tetrahedra.size() * 144);
  for (std::size_t n = 0; n < solid.tetrahedra.size(); ++n) {
    const Block k = stiffness_of(solid, n, material);
    const auto& t = solid.tetrahedra[n];
    for (int i = 0; i < 4; ++i) {
      const int row = unknown[t[i]];
      if (row < 0) continue;
      for (int j = 0; j < 4; ++j) {
        const std::uint32_t other = t[j];
        const int column = unknown[other];
        if (column < 0) {
          // What is known goes to the right-hand side.
          load.segment<3>(row) -= k.block<3, 3>(3 * i, 3 * j) * moved[other];
          continue;
        }
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c)
            // The lower triangle, which the factorisation reads.
            if (row + r >= column + c) entries.emplace_back(row + r, column + c, k(3 * i + r, 3 * j + c));
      }
    }
  }
  Eigen::SparseMatrix<double> stiffness(unknowns, unknowns);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(stiffness);
  if (factor.info() != Eigen::Success)
    throw InputError(
        "solve_elastic: the solid can move freely; expected at least three vertices held, not on one line");
  const Eigen::VectorXd solution = factor.solve(load);
  for (std::size_t v = 0; v < count; ++v)
    if (unknown[v] >= 0) moved[v] = solution.segment<3>(unknown[v]);
  return moved;
}

}  // namespace dynasurf::mesh
