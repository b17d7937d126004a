#include "dynasurf/ventricle/measures/tracked_motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double degrees = M_PI / 180;
const LongAxis axis{{10, -20, 30}, {10, -20, 110}};  // 80 mm, along z

/// Points of a wall 20 to 32 mm from the axis, whose middle they leave open.
std::vector<Vec3> wall_points(int count = 240) {
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n) {
    const double height = 80.0 * (n + 0.5) / count, angle = 2.399963 * n, radius = 20 + 4 * (n % 4);
    points.push_back(axis.apex + Vec3(radius * std::cos(angle), radius * std::sin(angle), height));
  }
  return points;
}

/// Narrower by 1/10, shorter by 1/20, turned by `twist` degrees from base to apex, seen from the apex, of which the
/// base has -3/10.
Vec3 contracted(const Vec3& p, double twist, const Vec3& shift = Vec3::Zero()) {
  const Vec3 q = p - axis.apex;
  const double turn = -twist * degrees * (0.7 - q[2] / 80);  // seen from the apex counter-clockwise: clockwise about z
  return axis.apex + shift +
         Vec3(0.9 * (std::cos(turn) * q[0] - std::sin(turn) * q[1]),
              0.9 * (std::sin(turn) * q[0] + std::cos(turn) * q[1]), 0.95 * q[2]);
}

TrackedPoints beat(double twist, double error_mm = 0, const Vec3& shift = Vec3::Zero()) {
  TrackedPoints points;
  points.gates = {wall_points(), {}};
  int n = 0;
  for (const Vec3& p : points.gates[0]) {
    points.name.push_back(std::to_string(++n));
    points.gates[1].push_back(contracted(p, twist, shift) +
                              error_mm * Vec3(std::sin(7.0 * n), std::cos(5.0 * n), std::sin(3.0 * n)));
  }
  return points;
}

TEST(MeasureMotion, IsAsUnsureOfTheTwistAsOfTheLengthOfTheAxis) {
  LongAxis unsure = axis;
  unsure.length_sd_mm = 4;  // of 80 mm
  const GateMotion sure = measure_motion(beat(19), axis).gates[1], other = measure_motion(beat(19), unsure).gates[1];
  EXPECT_DOUBLE_EQ(other.twist_deg, sure.twist_deg);
  EXPECT_NEAR(other.twist_sd_deg, std::hypot(sure.twist_sd_deg, sure.twist_deg / 20), 1e-9);
}

TEST(MeasureMotion, RecoversTwistTorsionAndRotationOfEveryLevel) {
  const TrackedMotion m = measure_motion(beat(19), axis);
  EXPECT_DOUBLE_EQ(m.length_mm, 80);
  EXPECT_EQ(m.peak_gate, 1);
  EXPECT_NEAR(m.gates[0].twist_deg, 0, 1e-9);
  const GateMotion& systole = m.gates[1];
  // Points that are not spread evenly around a level's middle leave hundredths of a degree.
  EXPECT_NEAR(systole.twist_deg, 19, 0.2);
  EXPECT_NEAR(systole.torsion_deg_per_cm, 19 / 8.0, 0.03);
  for (const auto level : {WallLevel::apex, WallLevel::mid, WallLevel::base}) {
    const auto& of = systole.levels[static_cast<std::size_t>(level)];
    ASSERT_TRUE(of);
    EXPECT_EQ(of->points, 80);
    EXPECT_NEAR(of->rotation_deg, 19 * (0.7 - of->height_mm / 80), 0.2);
  }
  EXPECT_NEAR(systole.levels[0]->height_mm, 80 / 6.0, 1);
  EXPECT_GT(systole.levels[0]->rotation_deg, 0);
  EXPECT_LT(systole.levels[2]->rotation_deg, 0);
  EXPECT_NEAR(measure_motion(beat(-19), axis).gates[1].twist_deg, -19, 0.2);
}

TEST(MeasureMotion, IsNotMisledByAHeartThatMovesAsAWhole) {
  const TrackedMotion still = measure_motion(beat(19), axis);
  const TrackedMotion moved = measure_motion(beat(19, 0, {6, -4, 3}), axis);
  EXPECT_NEAR(moved.gates[1].twist_deg, still.gates[1].twist_deg, 1e-9);
  EXPECT_NEAR(moved.gates[1].strains.radial_percent, still.gates[1].strains.radial_percent, 1e-9);
}

TEST(MeasureMotion, ReadsTheStrainsOfAKnownDeformation) {
  // Round the axis and away from it everything is 9/10 as long. A fibre along the axis is 19/20 as long and is sheared
  // by the twist: r times 19 degrees over 80 mm.
  const GateMotion systole = measure_motion(beat(19), axis).gates[1];
  EXPECT_NEAR(systole.strains.radial_percent, -10, 0.5);
  EXPECT_NEAR(systole.strains.circumferential_percent, -10, 0.5);
  double sum = 0;
  for (const double r : {20.0, 24.0, 28.0, 32.0}) sum += std::hypot(0.95, 0.9 * r * 19 * degrees / 80) / 4;
  EXPECT_NEAR(systole.strains.longitudinal_percent, 100 * (sum - 1), 0.5);
}

TEST(MeasureMotion, TellsHowSureItIsOfPointsThatAreOff) {
  const GateMotion exact = measure_motion(beat(19), axis).gates[1],
                   noisy = measure_motion(beat(19, 1.0), axis).gates[1];
  EXPECT_NEAR(noisy.twist_deg, 19, 2);
  EXPECT_NEAR(noisy.twist_deg, exact.twist_deg, 3 * noisy.twist_sd_deg);
  EXPECT_GT(noisy.twist_sd_deg, 2 * exact.twist_sd_deg);
  // A slip of 1/sqrt(2) mm in 240 points about 26 mm away, over heights that vary by 23 mm of 80.
  EXPECT_NEAR(noisy.twist_sd_deg, 0.71 / 26 / degrees / std::sqrt(240.0) * 80 / 23, 0.15);
}

TEST(MeasureMotion, CountsFromTheGateAtRest) {
  TrackedPoints points = beat(19);
  std::swap(points.gates[0], points.gates[1]);
  const TrackedMotion m = measure_motion(points, axis, 1);
  EXPECT_EQ(m.rest_gate, 1);
  EXPECT_NEAR(m.gates[0].twist_deg, 19, 0.2);
  EXPECT_THROW(measure_motion(points, axis, 2), OptionError);
  EXPECT_THROW(measure_motion(points, axis, -1), OptionError);
}

TEST(MeasureMotion, RefusesWhatTellsNoTwist) {
  TrackedPoints points = beat(19);
  EXPECT_THROW(measure_motion(points, {axis.apex, axis.apex}), InputError);
  TrackedPoints few = points;
  few.name.resize(11);
  for (auto& gate : few.gates) gate.resize(11);
  EXPECT_THROW(measure_motion(few, axis), InputError);
  TrackedPoints low = points;  // all in one third
  low.name.resize(80);
  for (auto& gate : low.gates) gate.resize(80);
  EXPECT_THROW(measure_motion(low, axis), InputError);
  TrackedPoints equal = points;
  equal.gates[0][1] = equal.gates[0][0];
  EXPECT_THROW(measure_motion(equal, axis), InputError);
  EXPECT_THROW(measure_motion({}, axis), OptionError);
}

}  // namespace
}  // namespace dynasurf::ventricle
