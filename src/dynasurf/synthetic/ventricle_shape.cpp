#include "dynasurf/synthetic/ventricle_shape.hpp"

#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/synthetic/detail/solids.hpp"

namespace dynasurf::synthetic {
namespace {

// The base plane lies above the widest place by this part of the cavity's half length: hearts narrow to the base.
constexpr double base_level = 0.4;
// The wall is thinner at the apex than at the sides.
constexpr double apex_thickness = 0.7;

double cut_ellipsoid_mm3(double radius, double half_length, double cut) {
  const double u = cut / half_length;
  return M_PI * radius * radius * half_length * (2.0 / 3.0 + u - u * u * u / 3);
}

double cavity_factor() { return M_PI * (2.0 / 3.0 + base_level - base_level * base_level * base_level / 3); }

VentricleShape make_shape(double endo_radius, double endo_half_length, double thickness) {
  VentricleShape s;
  s.endo_radius = endo_radius;
  s.endo_half_length = endo_half_length;
  s.epi_radius = endo_radius + thickness;
  s.epi_half_length = endo_half_length + apex_thickness * thickness;
  s.centre_z = s.epi_half_length;
  s.base_z = s.centre_z + base_level * endo_half_length;
  return s;
}

VentricleShape diastolic_shape(const VentricleMotion& m, double thickness) {
  const double length_per_radius = 2 * m.length_to_width / (1 + base_level);
  const double radius = own::cbrt(1000 * m.edv_ml / (length_per_radius * cavity_factor()));
  return make_shape(radius, length_per_radius * radius, thickness);
}

/// The shape of the given outer length; the cavity gets shorter and wider as the wall gets thicker.
VentricleShape contracted_shape(double volume_ml, double outer_length, double thickness) {
  const double half_length = (outer_length - apex_thickness * thickness) / (1 + base_level);
  return make_shape(std::sqrt(1000 * volume_ml / (cavity_factor() * half_length)), half_length, thickness);
}

/// The thickness at which the wall of `shape_of(thickness)` has the given volume, which grows with the thickness.
template <class ShapeOf>
VentricleShape with_wall(double wall_ml, double thickest, const ShapeOf& shape_of) {
  const auto excess = [&](double t) {
    const VentricleShape s = shape_of(t);
    return epi_ml(s) - endo_ml(s) - wall_ml;
  };
  if (excess(thickest) < 0) {
    TextOutput text;
    text << "option patient.wall_ml is " << wall_ml << "; expected a muscle volume that fits around the cavity";
    throw OptionError(text.str());
  }
  double low = 0, high = thickest;
  for (int n = 0; n < 200 && high - low > 1e-13 * thickest; ++n) {
    const double middle = (low + high) / 2;
    (excess(middle) < 0 ? low : high) = middle;
  }
  return shape_of((low + high) / 2);
}

TriMesh cut_ellipsoid_surface(double radius, double half_length, double centre_z, double base_z) {
  constexpr int wall_rings = 96, lid_rings = 16, segments = 96;
  const double top = own::acos(-(base_z - centre_z) / half_length);  // angle from the apex to the rim
  std::vector<ProfilePoint> profile;
  for (int n = 0; n <= wall_rings; ++n) {
    const double angle = top * n / wall_rings;
    profile.push_back({radius * own::sin(angle), centre_z - half_length * own::cos(angle)});
  }
  profile.back()[1] = base_z;
  const double rim = profile.back()[0];
  for (int n = lid_rings - 1; n >= 0; --n) profile.push_back({rim * n / lid_rings, base_z});
  return revolve(profile, segments);
}

double smooth_step(double x) { return x * x * (3 - 2 * x); }

}  // namespace

double endo_ml(const VentricleShape& s) {
  return cut_ellipsoid_mm3(s.endo_radius, s.endo_half_length, s.base_z - s.centre_z) / 1000;
}
double epi_ml(const VentricleShape& s) {
  return cut_ellipsoid_mm3(s.epi_radius, s.epi_half_length, s.base_z - s.centre_z) / 1000;
}

TriMesh endo_surface(const VentricleShape& s) {
  return cut_ellipsoid_surface(s.endo_radius, s.endo_half_length, s.centre_z, s.base_z);
}
TriMesh epi_surface(const VentricleShape& s) {
  return cut_ellipsoid_surface(s.epi_radius, s.epi_half_length, s.centre_z, s.base_z);
}

VentricleShape shape_at(const VentricleMotion& motion, double volume_ml) {
  constexpr double thickest_mm = 100;
  const VentricleShape relaxed =
      with_wall(motion.wall_ml, thickest_mm, [&](double t) { return diastolic_shape(motion, t); });
  const double stroke = motion.edv_ml - motion.esv_ml;
  const double put_out = stroke > 0 ? (motion.edv_ml - volume_ml) / stroke : 0;
  if (put_out <= 0) return relaxed;
  const double length = relaxed.base_z - put_out * motion.base_excursion_mm;
  if (length <= 0.3 * relaxed.base_z)
    throw OptionError("option patient.base_excursion_mm is too large; expected less than 0.7 of the heart's length");
  return with_wall(motion.wall_ml, std::min(thickest_mm, 0.95 * length / apex_thickness),
                   [&](double t) { return contracted_shape(volume_ml, length, t); });
}

double filling_at(double phase) {
  struct Knot {
    double phase, filling;
  };
  // Between the knots the curve runs smoothly and level at both ends.
  static constexpr std::array<Knot, 8> knots{
      {{0, 1}, {0.07, 1}, {0.39, 0}, {0.45, 0}, {0.67, 0.72}, {0.84, 0.79}, {0.97, 1}, {1, 1}}};
  phase -= std::floor(phase);
  std::size_t n = 0;
  while (n + 2 < knots.size() && knots[n + 1].phase <= phase) ++n;
  const Knot &a = knots[n], &b = knots[n + 1];
  return a.filling + (b.filling - a.filling) * smooth_step((phase - a.phase) / (b.phase - a.phase));
}

}  // namespace dynasurf::synthetic
