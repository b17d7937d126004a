#pragma once
#include "dynasurf/core/geometry.hpp"
#include "dynasurf/synthetic/options.hpp"

namespace dynasurf {

/// Activity of the trunk at a point given in the world (LPS, mm) against the middle of the heart: organs as ellipsoids
/// where they usually lie, `background` between them, 0 outside the skin. The heart itself is not in it. Internal.
double torso_activity(const Torso& torso, double background, const Vec3& from_heart);

}  // namespace dynasurf
