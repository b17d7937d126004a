#include "dynasurf/dynamics/detail/field_force.hpp"

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"

namespace dynasurf::dynamics {
namespace {

/// The hot loop of every run: four of these per step and particle with RK4.
class NearestMotion {
 public:
  NearestMotion(const field::VectorField& field, double pull_per_mass, double drag_per_mass)
      : x_(field.x.data()),
        y_(field.y.data()),
        z_(field.z.data()),
        per_mm_(field.grid.spacing.cwiseInverse()),
        dims_(field.grid.dims),
        pull_(pull_per_mass),
        drag_(drag_per_mass) {}

  void operator()(std::span<const double> y, std::span<double> dydt) const {
    for (std::size_t p = 0; p < y.size(); p += 6) {
      const std::size_t v = voxel(y[p], 0) + width() * (voxel(y[p + 1], 1) + height() * voxel(y[p + 2], 2));
      dydt[p] = y[p + 3];
      dydt[p + 1] = y[p + 4];
      dydt[p + 2] = y[p + 5];
      dydt[p + 3] = pull_ * x_[v] - drag_ * y[p + 3];
      dydt[p + 4] = pull_ * y_[v] - drag_ * y[p + 4];
      dydt[p + 5] = pull_ * z_[v] - drag_ * y[p + 5];
    }
  }

 private:
  std::size_t width() const { return dims_[0]; }
  std::size_t height() const { return dims_[1]; }
  /// Nearest voxel inside the grid.
  std::size_t voxel(double mm, std::size_t axis) const { return whole_within(mm * per_mm_[axis] + 0.5, dims_[axis]); }

  const float *x_, *y_, *z_;
  Vec3 per_mm_;
  Index3 dims_;
  double pull_, drag_;
};

}  // namespace

Derivative free_motion(field::FieldView field, const FieldForce& force, double particle_mass_kg,
                       const Image* drag_map) {
  const double pull = force.strength / particle_mass_kg;
  const auto general = [field, how = force.sampling, pull](auto drag_per_mass_at) -> Derivative {
    return [field, how, pull, drag_per_mass_at](std::span<const double> y, std::span<double> dydt) {
      for (std::size_t p = 0; p < y.size(); p += 6) {
        const Vec3 position(y[p], y[p + 1], y[p + 2]), velocity(y[p + 3], y[p + 4], y[p + 5]);
        const Vec3 acceleration =
            pull * field.at_point(position, how, velocity) - drag_per_mass_at(position) * velocity;
        for (std::size_t a = 0; a < 3; ++a) {
          dydt[p + a] = y[p + 3 + a];
          dydt[p + 3 + a] = acceleration[a];
        }
      }
    };
  };
  if (drag_map != nullptr)
    return general([drag_map, particle_mass_kg](const Vec3& p) { return drag_at(*drag_map, p) / particle_mass_kg; });
  const double drag = force.drag / particle_mass_kg;
  if (force.sampling == field::Sampling::nearest && field.dense() != nullptr)
    return NearestMotion(*field.dense(), pull, drag);
  return general([drag](const Vec3&) { return drag; });
}

}  // namespace dynasurf::dynamics
