#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {
namespace {

std::size_t nearest(double mm, double spacing_mm, int count) { return whole_within(mm / spacing_mm + 0.5, count); }

/// Drag that `drag_at(position)` gives.
template <class DragAt>
Force make_drag(DragAt drag_at) {
  return {"drag",
          [drag_at](const ParticleState& s, std::span<Vec3> forces) {
            for (std::size_t p = 0; p < forces.size(); ++p) forces[p] -= drag_at(s.positions[p]) * s.velocities[p];
          },
          [drag_at](const ParticleState& s, ForceJacobian& jacobian) {
            for (std::uint32_t p = 0; p < s.positions.size(); ++p)
              jacobian.add(p, p, Mat3::Zero(), -drag_at(s.positions[p]) * Mat3::Identity());
          }};
}

}  // namespace

double drag_at(const Image& volume, const Vec3& p) {
  const Grid& g = volume.grid;
  const std::size_t width = g.dims[0], height = g.dims[1];
  return volume
      .values[nearest(p[0], g.spacing[0], g.dims[0]) +
              width * (nearest(p[1], g.spacing[1], g.dims[1]) + height * nearest(p[2], g.spacing[2], g.dims[2]))];
}

Force drag_force(double drag_kg_s) {
  return make_drag([drag_kg_s](const Vec3&) { return drag_kg_s; });
}

Force drag_force(const Image& drag_kg_s) {
  return make_drag([&drag_kg_s](const Vec3& p) { return drag_at(drag_kg_s, p); });
}

}  // namespace dynasurf::dynamics
