#include "dynasurf/synthetic/detail/torso.hpp"

#include <array>

namespace dynasurf {
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

bool in_body(const Vec3& p) {
  const double x = (p[0] + 45) / 175, y = (p[1] - 35) / 125;
  return x * x + y * y <= 1;
}

}  // namespace

double torso_activity(const Torso& torso, double background, const Vec3& from_heart) {
  if (!in_body(from_heart)) return 0;
  for (const TrunkPart& organ : organs())
    if (holds(organ, from_heart)) return torso.*organ.activity;
  return background;
}

}  // namespace dynasurf
