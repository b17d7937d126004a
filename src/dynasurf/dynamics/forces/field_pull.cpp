#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {

Force field_pull(field::FieldView field, double strength, field::Sampling sampling) {
  return {"field", [field, strength, sampling](const ParticleState& s, std::span<Vec3> forces) {
            for (std::size_t p = 0; p < forces.size(); ++p)
              if (!s.is_pinned(p)) forces[p] += strength * field.at_point(s.positions[p], sampling, s.velocities[p]);
          }};
}

}  // namespace dynasurf::dynamics
