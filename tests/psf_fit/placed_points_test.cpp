#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/psf_fit/blur_fit.hpp"

#include "psf_fit/small_study.hpp"

namespace dynasurf::psf_fit {
namespace {

using test::biased_start;
using test::known_blur;
using test::small_study;

/// A vertex half way up the wall, in the middle of its open part.
constexpr int ring = 12;
std::size_t vertex_at(const FittedBeat& beat, int segment) {
  return static_cast<std::size_t>(1 + (ring - 1) * beat.segments + segment);
}

const TriMesh& wall_of(const FittedGate& gate, bool is_outer) { return is_outer ? gate.epi : gate.endo; }

double distance_from(const TriMesh& wall, const Vec3& place) {
  return std::sqrt(mesh::ClosestPoint(wall)(place).distance2);
}

/// A wall moves to a place that a person says, 4 mm outside or inside of where the image shows it; what lies on the
/// other side of the heart stays.
void expect_followed(bool is_outer, double by_mm) {
  const synthetic::Phantom phantom = small_study(12);
  FitStart start = biased_start(phantom);
  const FittedBeat found = fit_through_blur(phantom.study, start, known_blur(12));
  constexpr int gate = 1;
  const TriMesh& before = wall_of(found.gates[gate], is_outer);
  const Vec3 here = before.vertices[vertex_at(found, 0)];
  const Vec3 there = before.vertices[vertex_at(found, found.segments / 2)];
  const Vec3 placed = here + by_mm * (here - there).normalized();
  start.points = {{gate, is_outer, placed}};
  const FittedBeat moved = fit_through_blur(phantom.study, start, known_blur(12));
  const TriMesh& after = wall_of(moved.gates[gate], is_outer);
  EXPECT_GT(distance_from(before, placed), 0.6 * std::abs(by_mm));
  EXPECT_LT(distance_from(after, placed), 0.5);
  EXPECT_LT((after.vertices[vertex_at(moved, moved.segments / 2)] - there).norm(), 0.3 * std::abs(by_mm));
  const double volume = is_outer ? moved.gates[gate].epi_ml.value - found.gates[gate].epi_ml.value
                                 : moved.gates[gate].endo_ml.value - found.gates[gate].endo_ml.value;
  EXPECT_GT(volume * by_mm, 0);
  EXPECT_GT(std::abs(volume), 0.2);
  EXPECT_TRUE(moved.converged);
}

TEST(PlacedPoints, OnTheInnerWallAreFollowedOutwards) { expect_followed(false, 4); }
TEST(PlacedPoints, OnTheInnerWallAreFollowedInwards) { expect_followed(false, -4); }
TEST(PlacedPoints, OnTheOuterWallAreFollowed) { expect_followed(true, 4); }

/// Points 2 mm outside a reported wall at end-systole lie on it afterwards.
void expect_on_reported_wall(const Study& study, FitStart start, bool is_outer = false,
                             Attenuation attenuation = Attenuation::uncorrected) {
  BlurFit options = known_blur(12);
  options.papillary_share = 0.016;
  options.attenuation = attenuation;
  const FittedBeat found = fit_through_blur(study, start, options);
  const int gate = found.es_gate;
  for (int segment = 0; segment < found.segments; segment += 12) {
    const TriMesh& wall = wall_of(found.gates[gate], is_outer);
    const Vec3 here = wall.vertices[vertex_at(found, segment)];
    const Vec3 there = wall.vertices[vertex_at(found, (segment + found.segments / 2) % found.segments)];
    start.points.push_back({gate, is_outer, here + 2 * (here - there).normalized()});
  }
  const FittedBeat moved = fit_through_blur(study, start, options);
  for (const WallPoint& point : start.points) {
    EXPECT_GT(distance_from(wall_of(found.gates[gate], is_outer), point.place), 1.5);
    EXPECT_LT(distance_from(wall_of(moved.gates[gate], is_outer), point.place), 0.25);
  }
}

/// What a camera does to contracted hearts, and papillary muscles, move the reported wall off the fitted one.
TEST(PlacedPoints, LieOnTheReportedWallWhereItIsMovedOffTheFittedOne) {
  const synthetic::Phantom phantom = small_study(12);
  expect_on_reported_wall(phantom.study, biased_start(phantom));
}

TEST(PlacedPoints, LieOnTheReportedWallWhereEdgesMovedIt) {
  synthetic::Phantom phantom = small_study(12, 0, 0, 8);
  test::add_stripes(phantom.study);
  FitStart start = biased_start(phantom);
  const FittedBeat fitted = fit_through_blur(phantom.study, start, known_blur(12));
  for (const auto& gate : fitted.gates) start.edge_ml.push_back(1.2 * gate.endo_ml.value);
  const FittedBeat moved = fit_through_blur(phantom.study, start, known_blur(12));
  ASSERT_GT(moved.edv_ml.value, 1.1 * fitted.edv_ml.value);
  expect_on_reported_wall(phantom.study, start);
}

TEST(PlacedPoints, LieOnTheReportedOuterWallWhereRecoveredResolutionMovedIt) {
  synthetic::Phantom phantom = small_study(12);
  test::add_stripes(phantom.study);
  expect_on_reported_wall(phantom.study, biased_start(phantom), true, Attenuation::corrected);
}

TEST(PlacedPoints, WhereTheWallIsAnywayChangeNothingAndNarrowItsErrors) {
  const synthetic::Phantom phantom = small_study(12);
  FitStart start = biased_start(phantom);
  const FittedBeat found = fit_through_blur(phantom.study, start, known_blur(12));
  for (int segment = 0; segment < found.segments; segment += 8)
    start.points.push_back({0, false, found.gates[0].endo.vertices[vertex_at(found, segment)]});
  const FittedBeat same = fit_through_blur(phantom.study, start, known_blur(12));
  EXPECT_NEAR(same.edv_ml.value / found.edv_ml.value, 1, 0.01);
  EXPECT_LT(same.gates[0].endo_ml.sd, found.gates[0].endo_ml.sd);
}

TEST(PlacedPoints, InTheMiddleOfTheHeartOrFarFromItAreRefused) {
  const synthetic::Phantom phantom = small_study(12);
  FitStart start = biased_start(phantom);
  const Vec3 middle = 0.5 * (start.base.front()->point + start.endo.front().vertices.front());
  for (const Vec3& place : {middle, Vec3(middle + 300 * start.lateral)}) {
    start.points = {{2, false, place}};
    try {
      fit_through_blur(phantom.study, start, known_blur(12));
      ADD_FAILURE();
    } catch (const OptionError& e) {
      EXPECT_NE(std::string(e.what()).find("inner wall of gate 3 lies"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace dynasurf::psf_fit
