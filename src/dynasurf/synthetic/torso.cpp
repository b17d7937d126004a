#include "dynasurf/synthetic/detail/torso.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::synthetic {
namespace {

/// Middle and half axes, mm, against the middle of the heart: x to the left, y to the back, z to the head.
struct TrunkPart {
  double Torso::*activity;
  Vec3 middle, half;
};

// Read off an anatomical atlas to a centimetre or so. The first organ that holds a point counts.
const std::array<TrunkPart, 12>& organs() {
  static const std::array<TrunkPart, 12> all{{
      {&Torso::gallbladder, {-70, -55, -115}, {14, 14, 22}},
      {&Torso::liver, {-110, 15, -85}, {95, 80, 65}},  // right lobe
      {&Torso::liver, {-40, -25, -78}, {70, 45, 38}},  // left lobe, below the heart
      {&Torso::spleen, {78, 95, -70}, {30, 40, 55}},
      {&Torso::kidneys, {25, 95, -150}, {25, 25, 55}},
      {&Torso::kidneys, {-110, 95, -160}, {25, 25, 55}},
      {&Torso::bowel, {-20, -50, -185}, {95, 25, 25}},
      {&Torso::bowel, {45, -40, -240}, {30, 25, 60}},
      {&Torso::bowel, {-125, -30, -250}, {30, 25, 70}},
      {&Torso::bladder, {-45, 5, -430}, {40, 35, 35}},
      {&Torso::lung, {30, 45, 60}, {58, 78, 105}},
      {&Torso::lung, {-125, 30, 55}, {60, 80, 110}},
  }};
  return all;
}

bool holds(const TrunkPart& organ, const Vec3& p) {
  return (p - organ.middle).cwiseQuotient(organ.half).squaredNorm() <= 1;
}

/// An ellipse that runs along the body, mm.
struct Trunk {
  double x = 0, y = 0, half_x = 1, half_y = 1;
  bool holds(const Vec3& p) const {
    const double u = (p[0] - x) / half_x, v = (p[1] - y) / half_y;
    return u * u + v * v <= 1;
  }
  /// How far it reaches into a direction from the heart.
  double reach(double dx, double dy) const {
    return x * dx + y * dy + std::sqrt(half_x * half_x * dx * dx + half_y * half_y * dy * dy);
  }
};
constexpr Trunk body{-45, 35, 175, 125}, spine{-45, 122, 19, 17};
constexpr std::array<Trunk, 2> arms{{{-45 + 162, 35, 40, 45}, {-45 - 162, 35, 40, 45}}};

bool in_body(const Vec3& p) { return body.holds(p); }

}  // namespace

double torso_activity(const Torso& torso, double background, const Vec3& from_heart) {
  if (!in_body(from_heart)) return 0;
  for (const TrunkPart& organ : organs())
    if (holds(organ, from_heart)) return torso.*organ.activity;
  return background;
}

double torso_attenuation(bool arms_down, const Vec3& p) {
  // Of 140 keV: lung of a third of the density of water; vertebrae, marrow and bone together.
  constexpr double lung = 0.005, bone = 0.020;
  if (!in_body(p)) {
    const bool in_arm = arms_down && std::any_of(arms.begin(), arms.end(), [&](const Trunk& a) { return a.holds(p); });
    return in_arm ? soft_tissue_per_mm : 0;
  }
  if (spine.holds(p)) return bone;
  for (const TrunkPart& organ : organs())
    if (holds(organ, p)) return organ.activity == &Torso::lung ? lung : soft_tissue_per_mm;
  return soft_tissue_per_mm;
}

double torso_reach_mm(bool arms_down, double angle, const Vec3& heart) {
  const double dx = own::sin(angle), dy = -own::cos(angle);
  double reach = body.reach(dx, dy);
  if (arms_down)
    for (const Trunk& arm : arms) reach = std::max(reach, arm.reach(dx, dy));
  return reach + heart[0] * dx + heart[1] * dy;
}

}  // namespace dynasurf::synthetic
