#pragma once
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::synthetic {

/// A left ventricle at one instant: two ellipsoids of revolution with a common centre, cut by the base plane.
/// Frame of the heart: z along the axis from the apex (outer surface at z = 0) to the base, +x towards the lateral
/// wall, +y towards the inferior wall.
struct VentricleShape {
  double endo_radius = 0, endo_half_length = 0;  // half axes across and along, mm
  double epi_radius = 0, epi_half_length = 0;
  double centre_z = 0;  // of both ellipsoids, mm
  double base_z = 0;    // height of the base plane, mm

  bool in_endo(const Vec3& p) const { return p[2] <= base_z && endo_level(p) <= 1; }
  bool in_epi(const Vec3& p) const { return p[2] <= base_z && epi_level(p) <= 1; }
  double endo_level(const Vec3& p) const { return level(p, endo_radius, endo_half_length); }
  double epi_level(const Vec3& p) const { return level(p, epi_radius, epi_half_length); }

 private:
  double level(const Vec3& p, double radius, double half_length) const {
    const double z = (p[2] - centre_z) / half_length;
    return (p[0] * p[0] + p[1] * p[1]) / (radius * radius) + z * z;
  }
};

/// Volumes closed by the base plane, by the formula of the cut ellipsoid.
double endo_ml(const VentricleShape& shape);
double epi_ml(const VentricleShape& shape);

/// The surfaces closed by the base plane, in the frame of the heart. More than 10,000 vertices; the same triangles for
/// every shape.
TriMesh endo_surface(const VentricleShape& shape);
TriMesh epi_surface(const VentricleShape& shape);

/// A ventricle that beats: what stays the same while its volume changes.
struct VentricleMotion {
  double edv_ml = 0, esv_ml = 0, wall_ml = 0;
  double length_to_width = 0;    // of the cavity at end-diastole
  double base_excursion_mm = 0;  // how far the base plane comes down from end-diastole to end-systole
};

/// The shape at which the cavity has `volume_ml`: the muscle has `wall_ml` exactly, the base plane has come down in
/// proportion to the blood put out, the outer apex stays. Throws OptionError when no such shape exists.
VentricleShape shape_at(const VentricleMotion& motion, double volume_ml);

/// Volume of a beating ventricle as a part of the stroke volume above ESV, at `phase` (0..1 of the beat after the R
/// wave): 1 until the valves open (0.07), 0 at end-systole (0.39 to 0.45), rapid filling, diastasis, atrial kick.
/// Smooth (one continuous derivative) and periodic.
double filling_at(double phase);

}  // namespace dynasurf::synthetic
