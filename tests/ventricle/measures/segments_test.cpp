#include "dynasurf/ventricle/measures/detail/segments.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace dynasurf::ventricle {
namespace {

HeartAxes leaning_axes() {
  HeartAxes axes;
  axes.axis = Vec3(-0.6, 0.6, 0.5).normalized();
  axes.apex = {40, -30, 5};
  axes.anterior = find_anterior(axes.axis, Grid{}, AnteriorRule::patient).direction;
  axes.length_mm = 80;
  axes.base_normal = (axes.axis + 0.1 * axes.anterior).normalized();
  return axes;
}

TEST(HeartAxes, SeesLateralAnteriorAndBaseAsAFrameOfThePatient) {
  const HeartAxes axes = leaning_axes();
  EXPECT_GT(axes.anterior[2], 0.7);   // towards the head
  EXPECT_GT(axes.lateral()[0], 0.5);  // to the patient's left
  EXPECT_GT(axes.lateral()[1], 0.3);  // and back, as the free wall lies
  EXPECT_NEAR(axes.lateral().cross(-axes.anterior).dot(axes.axis), 1, 1e-12);
}

TEST(HeartAxes, GivesBackThePolarPointOfAPointOnItsRay) {
  const HeartAxes axes = leaning_axes();
  for (const double rho : {0.05, 0.2, 0.3, 0.49, 0.51, 0.7, 0.95})
    for (const double angle : {1.0, 95.0, 185.0, 275.0, 359.0}) {
      const double radius = 27;
      const WallRay ray = axes.ray({rho, angle}, radius);
      const PolarPoint at = axes.polar(ray.origin + radius * ray.direction);
      EXPECT_NEAR(at.rho, rho, 1e-9);
      EXPECT_NEAR(at.angle_deg, angle, 1e-9);
    }
}

TEST(Anterior, IsTowardsTheHeadInAPatientAndAgainstTheRowsInAnArray) {
  Grid grid;  // axes of the world: slices along z say nothing of a patient
  Anterior a = find_anterior({0, 0, 1}, grid, AnteriorRule::automatic);
  EXPECT_EQ(a.rule, AnteriorRule::rows);
  EXPECT_NEAR(a.direction.dot(Vec3(0, -1, 0)), 1, 1e-12);
  a = find_anterior(Vec3(-0.6, 0.6, 0.5).normalized(), grid, AnteriorRule::automatic);
  EXPECT_EQ(a.rule, AnteriorRule::patient);
  EXPECT_NEAR(a.direction.norm(), 1, 1e-12);
  EXPECT_NEAR(a.direction.dot(Vec3(-0.6, 0.6, 0.5)), 0, 1e-12);
}

TEST(Segments, CoverTheMapOnceAndEqually) {
  for (const SegmentModel model : {SegmentModel::aha17, SegmentModel::segments20}) {
    std::vector<double> area(segments_of(model).size() + 1, 0.0);
    for (int r = 0; r < 64; ++r)
      for (int a = 0; a < 720; ++a) {
        const PolarPoint at{(r + 0.5) / 64, a * 0.5 + 0.25};
        int holders = 0;
        for (const Segment& s : segments_of(model)) {
          double d = std::abs(std::remainder(at.angle_deg - s.middle_deg, 360.0));
          holders += at.rho >= s.rho_low && at.rho < s.rho_high && d < s.width_deg / 2 + 1e-9;
        }
        ASSERT_EQ(holders, 1);
        area[static_cast<std::size_t>(segment_at(model, at))] += 1;
      }
    EXPECT_EQ(area[0], 0);
    for (const Segment& s : segments_of(model))
      EXPECT_EQ(area[static_cast<std::size_t>(s.number)], (s.rho_high - s.rho_low) * 64 * s.width_deg * 2) << s.number;
  }
}

TEST(Segments, BearTheNamesOfTheirPlaces) {
  const auto name_at = [](double rho, double angle) {
    return segments_of(SegmentModel::aha17)[static_cast<std::size_t>(segment_at(SegmentModel::aha17, {rho, angle}) - 1)]
        .name;
  };
  EXPECT_EQ(name_at(0.9, 90), "basal anterior");
  EXPECT_EQ(name_at(0.9, 150), "basal anteroseptal");
  EXPECT_EQ(name_at(0.6, 270), "mid inferior");
  EXPECT_EQ(name_at(0.6, 359), "mid inferolateral");
  EXPECT_EQ(name_at(0.3, 10), "apical lateral");
  EXPECT_EQ(name_at(0.3, 350), "apical lateral");
  EXPECT_EQ(name_at(0.3, 180), "apical septal");
  EXPECT_EQ(name_at(0.1, 200), "apex");
  EXPECT_EQ(segment_at(SegmentModel::aha17, {1.0, 90}), 1);
  EXPECT_EQ(segment_at(SegmentModel::aha17, {1.01, 90}), 0);
  EXPECT_EQ(segment_at(SegmentModel::segments20, {0.1, 90}), 19);
  EXPECT_EQ(segment_at(SegmentModel::segments20, {0.1, 270}), 20);
}

TEST(Segments, OfVerticesLeaveTheLidOut) {
  const HeartAxes axes = leaning_axes();
  const std::vector<Vec3> vertices{axes.base() + 10 * axes.anterior, axes.centre() + 30 * axes.anterior, axes.apex};
  // The first lies above the leaning plane.
  EXPECT_EQ(segments_of_vertices(SegmentModel::aha17, axes, vertices), (std::vector<int>{0, 7, 17}));
}

}  // namespace
}  // namespace dynasurf::ventricle
