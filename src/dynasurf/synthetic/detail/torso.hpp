#pragma once
#include "dynasurf/core/grid.hpp"
#include "dynasurf/synthetic/options.hpp"

namespace dynasurf::synthetic {

/// Activity of the trunk at a point given in the world (LPS, mm) against the middle of the heart: organs as ellipsoids
/// where they usually lie, `background` between them, 0 outside the skin. The heart itself is not in it. Internal.
double torso_activity(const Torso& torso, double background, const Vec3& from_heart);

/// Linear attenuation of soft tissue for photons of 140 keV, 1/mm.
inline constexpr double soft_tissue_per_mm = 0.015;
/// Attenuation of the trunk at such a point, 1/mm: soft tissue, lungs, the spine, and arms where they lie beside it.
/// The heart is not in it: where it displaces lung, it is soft tissue.
double torso_attenuation(bool arms_down, const Vec3& from_heart);
/// How far skin and arms reach from the axis x = y = 0 of the world towards a camera at `angle` (0 in front, rising to
/// the patient's left), where the heart lies at `heart`.
double torso_reach_mm(bool arms_down, double angle, const Vec3& heart);

}  // namespace dynasurf::synthetic
