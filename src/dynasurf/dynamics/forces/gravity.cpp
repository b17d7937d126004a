#include <memory>

#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {

Force gravity_force(std::vector<double> masses, const Vec3& g) {
  const auto shared = std::make_shared<const std::vector<double>>(std::move(masses));
  return {"gravity",
          [shared, g](const ParticleState&, std::span<Vec3> forces) {
            for (std::size_t p = 0; p < forces.size(); ++p) forces[p] += (*shared)[p] * g;
          },
          [](const ParticleState&, ForceJacobian&) {},  // constant: nothing to add
          [shared, g](const ParticleState& s) {
            double sum = 0;
            for (std::size_t p = 0; p < s.positions.size(); ++p) sum -= (*shared)[p] * g.dot(s.positions[p]);
            return sum;
          }};
}

}  // namespace dynasurf::dynamics
