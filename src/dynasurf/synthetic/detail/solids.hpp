#pragma once
#include <array>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::synthetic {

/// Radius and height of a point of a profile, mm.
using ProfilePoint = std::array<double, 2>;

/// Surface of revolution around z of a profile that starts and ends on the axis (radius 0) and runs upwards along the
/// outside, then inwards over the lid. Closed and oriented outwards; (profile.size() - 2) * segments + 2 vertices in
/// the order apex, rings, lid. Each ring is a polygon of the *area* of its circle, so that a fine profile gives the
/// volume of the solid itself, not of a body inside it.
TriMesh revolve(const std::vector<ProfilePoint>& profile, int segments);

/// "Cylinder on half sphere" of thesis app. D (eqs. D.1-D.3): the half sphere below z = 0, the cylinder up to
/// height_mm.
struct CylinderCup {
  double radius_mm = 0, height_mm = 0;
  bool contains(const Vec3& p) const {
    const double across = p[0] * p[0] + p[1] * p[1], down = p[2] < 0 ? p[2] * p[2] : 0;
    return p[2] <= height_mm && across + down <= radius_mm * radius_mm;
  }
};

/// (1/2)(4/3) pi r^3 + pi r^2 H (eq. D.3).
double volume_ml(const CylinderCup& cup);
/// Its surface with a flat lid; more than 10,000 vertices.
TriMesh surface(const CylinderCup& cup);

/// Surface of a sphere around the origin; more than 10,000 vertices.
TriMesh sphere_surface(double radius_mm);

}  // namespace dynasurf::synthetic
