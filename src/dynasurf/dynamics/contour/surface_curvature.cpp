#include "dynasurf/dynamics/contour/detail/surface_curvature.hpp"

#include <cmath>

#include "dynasurf/mesh/detail/vertex_normals.hpp"
#include "dynasurf/mesh/smooth.hpp"

namespace dynasurf::dynamics {
namespace {

/// Mean over the ring of a vertex of what a neighbour gives; 0 without a ring.
template <class F>
double ring_mean(const mesh::VertexRings& rings, std::uint32_t v, F value) {
  const auto ring = rings.of(v);
  double sum = 0;
  for (const std::uint32_t j : ring) sum += value(j);
  return ring.empty() ? 0 : sum / ring.size();
}

std::vector<double> curvatures(const TriMesh& mesh, const mesh::VertexRings& rings, const std::vector<Vec3>& normals) {
  std::vector<double> k(mesh.vertices.size(), 0.0);
  for (std::uint32_t v = 0; v < k.size(); ++v)
    k[v] = ring_mean(rings, v, [&](std::uint32_t j) {
      const Vec3 d = mesh.vertices[v] - mesh.vertices[j];
      const double square = d.squaredNorm();
      return square > 0 ? 2 * normals[v].dot(d) / square : 0.0;
    });
  return k;
}

}  // namespace

std::vector<double> vertex_curvatures(const TriMesh& mesh) {
  return curvatures(mesh, mesh::vertex_rings(mesh), mesh::angle_weighted_normals(mesh));
}

namespace {

std::vector<Vec3> force_on(const TriMesh& mesh, const mesh::VertexRings& rings) {
  const std::vector<Vec3> normals = mesh::angle_weighted_normals(mesh);
  const std::vector<double> k = curvatures(mesh, rings, normals);
  std::vector<Vec3> force(mesh.vertices.size(), Vec3::Zero());
  for (std::uint32_t v = 0; v < k.size(); ++v) {
    // Neighbours on a boundary have no curvature to compare with.
    double sum = 0, length = 0;
    int count = 0;
    for (const std::uint32_t j : rings.of(v)) {
      length += (mesh.vertices[v] - mesh.vertices[j]).norm();
      if (rings.of(j).empty()) continue;
      sum += k[j];
      ++count;
    }
    if (count == 0) continue;
    const double edge = length / rings.of(v).size();
    force[v] = -(k[v] - sum / count) * edge * normals[v];
  }
  return force;
}

}  // namespace

std::vector<Vec3> surface_curvature_force(const TriMesh& mesh) { return force_on(mesh, mesh::vertex_rings(mesh)); }

Force surface_curvature_force(const TriMesh& mesh, double strength) {
  const auto add = [mesh, strength, rings = mesh::vertex_rings(mesh)](const ParticleState& state,
                                                                      std::span<Vec3> forces) {
    const TriMesh now{{state.positions.begin(), state.positions.end()}, mesh.triangles};
    const std::vector<Vec3> force = force_on(now, rings);
    for (std::size_t v = 0; v < forces.size(); ++v) forces[v] += strength * force[v];
  };
  // The force takes differences twice. What that can stiffen at most stands on the diagonal, along the normals: it
  // bounds the step of explicit solvers, and makes implicit ones stable, though slower to follow.
  const auto bound = [mesh, strength, rings = mesh::vertex_rings(mesh)](const ParticleState& state,
                                                                        ForceJacobian& jacobian) {
    const TriMesh now{{state.positions.begin(), state.positions.end()}, mesh.triangles};
    const std::vector<Vec3> normals = mesh::angle_weighted_normals(now);
    const std::uint32_t count = now.vertices.size();
    std::vector<double> slope(count), edge(count);
    for (std::uint32_t v = 0; v < count; ++v) {
      const auto apart = [&](std::uint32_t j) { return (now.vertices[v] - now.vertices[j]).squaredNorm(); };
      slope[v] = ring_mean(rings, v, [&](std::uint32_t j) { return apart(j) > 0 ? 2 / apart(j) : 0.0; });
      edge[v] = ring_mean(rings, v, [&](std::uint32_t j) { return std::sqrt(apart(j)); });
    }
    for (std::uint32_t v = 0; v < count; ++v) {
      if (state.is_pinned(v)) continue;
      const double around = ring_mean(rings, v, [&](std::uint32_t j) { return slope[j]; });
      const double most = 2 * strength * edge[v] * (slope[v] + around);
      jacobian.add(v, v, -most * normals[v] * normals[v].transpose(), Mat3::Zero());
    }
  };
  return {"surface_curvature", add, bound};
}

}  // namespace dynasurf::dynamics
