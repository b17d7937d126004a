#pragma once
#include "dynasurf/core/grid.hpp"

namespace dynasurf::mesh {

// On which side a point lies, decided exactly: the sign is that of the true determinant of the coordinates as they are
// stored, whatever their rounding. A filter decides the clear cases at the cost of the plain formula; the others are
// computed without rounding (Shewchuk, Adaptive precision floating-point arithmetic, 1997).
// Precondition: finite coordinates whose differences lie between 1e-90 and 1e90 or are 0, or products would leave the
// range of doubles.

/// +1 when d lies below the plane of a, b, c, that is where the triangle looks clockwise; -1 above; 0 in the plane.
/// The sign of det[a - d, b - d, c - d].
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// +1 when a, b, c turn counter-clockwise as seen against the axis that is left out (0: seen in the plane y, z;
/// 1: z, x; 2: x, y), -1 clockwise, 0 on one line there.
int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int left_out);

}  // namespace dynasurf::mesh
