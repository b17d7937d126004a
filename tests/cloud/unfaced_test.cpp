#include "dynasurf/cloud/detail/unfaced.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/cloud/detail/certificate.hpp"
#include "dynasurf/cloud/detail/support.hpp"
#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"

namespace dynasurf::cloud {
namespace {

constexpr double spacing = 0.02, half_thickness = 0.05;

/// A slab of 2 x 2 x 0.1.
TriMesh slab() {
  TriMesh mesh = mesh::cube_surface(80);
  for (Vec3& v : mesh.vertices) v.z() *= half_thickness;
  return mesh;
}

/// Feet in squares of `side` on all sides of the slab.
std::vector<Foot> feet_on_slab(double side = spacing) {
  const Vec3 half(1, 1, half_thickness);
  std::vector<Foot> feet;
  for (int axis = 0; axis < 3; ++axis)
    for (const int sign : {-1, 1}) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      for (double s = side / 2; s < 2 * half[a]; s += side)
        for (double t = side / 2; t < 2 * half[b]; t += side) {
          Foot foot{Vec3::Zero(), sign * Vec3::Unit(axis), 0};
          foot.place[axis] = sign * half[axis];
          foot.place[a] = s - half[a];
          foot.place[b] = t - half[b];
          feet.push_back(foot);
        }
    }
  return feet;
}

void erase_rim(std::vector<Foot>& feet) {
  std::erase_if(feet, [](const Foot& f) { return f.normal.x() > 0.5; });
}

TEST(Unfaced, NothingIsWherePointsLieOnAllSides) {
  const UnfacedParts parts = unfaced_parts(slab(), feet_on_slab(), spacing, 0);
  EXPECT_EQ(parts.points, 0);
  EXPECT_TRUE(parts.places.empty());
}

// All of it lies within 2.5 spacings of points, but they face up and down.
TEST(Unfaced, ARimWithoutPointsIsSoManyPointsShort) {
  std::vector<Foot> feet = feet_on_slab();
  erase_rim(feet);
  ASSERT_EQ(feet_on_slab().size() - feet.size(), 500u);
  const TriMesh mesh = slab();
  const UnfacedParts parts = unfaced_parts(mesh, feet, spacing, 0);
  EXPECT_NEAR(parts.points, 500, 15);
  ASSERT_GT(parts.places.size(), 400u);
  for (const UnfacedPlace& p : parts.places) EXPECT_NEAR(p.place.x(), 1, 1e-9);

  std::vector<float> confidence(mesh.vertices.size(), 1);
  doubt_unfaced(parts, mesh, confidence);
  for (std::size_t v = 0; v < confidence.size(); ++v) {
    const Vec3& at = mesh.vertices[v];
    if (at.x() > 0.999 && std::abs(at.z()) < 0.9 * half_thickness && std::abs(at.y()) < 0.9) {
      EXPECT_LT(confidence[v], 0.75) << at.transpose();
    }
    if (at.x() < 0.999) {
      EXPECT_EQ(confidence[v], 1) << at.transpose();
    }
  }
}

// Two rims are two parts.
TEST(Unfaced, TheLargestPartCounts) {
  std::vector<Foot> feet = feet_on_slab();
  std::erase_if(feet,
                [](const Foot& f) { return std::abs(f.normal.x()) > 0.5 && (f.place.x() > 0 || f.place.y() > 0); });
  const UnfacedParts parts = unfaced_parts(slab(), feet, spacing, 0);
  EXPECT_NEAR(parts.points, 500, 15);
  EXPECT_TRUE(
      std::any_of(parts.places.begin(), parts.places.end(), [](const UnfacedPlace& p) { return p.place.x() < 0; }));
}

// Of a hole in a smooth surface the distance tells, which `made_up` measures.
TEST(Unfaced, AHoleInASmoothSurfaceIsNot) {
  std::vector<Foot> feet = feet_on_slab();
  std::erase_if(feet, [](const Foot& f) { return f.normal.z() > 0.5 && f.place.head<2>().norm() < 0.09; });
  EXPECT_EQ(unfaced_parts(slab(), feet, spacing, 0).points, 0);
}

TEST(Unfaced, AFewPointsMayBeMissingByChance) {
  std::vector<Foot> feet = feet_on_slab();
  std::erase_if(feet, [](const Foot& f) { return f.normal.x() > 0.5 && std::abs(f.place.y()) < 0.05; });
  const UnfacedParts parts = unfaced_parts(slab(), feet, spacing, 0);
  EXPECT_LT(parts.points, UnfacedParts::fewest_points);
  EXPECT_TRUE(parts.places.empty());
}

TEST(Unfaced, ThinlyScannedSurfaceOughtToHoldFewerPoints) {
  std::vector<Foot> feet = feet_on_slab(), thinned;
  erase_rim(feet);
  for (std::size_t i = 0; i < feet.size(); ++i)
    if (feet[i].place.x() < 0.3 || i % 16 == 0) thinned.push_back(feet[i]);
  const double points = unfaced_parts(slab(), thinned, spacing, 0).points;
  EXPECT_GT(points, UnfacedParts::fewest_points);
  EXPECT_LT(points, 150);
}

/// What a level and the feet of its points say together.
CloudSupport support_of(TriMesh mesh, const std::vector<Foot>& feet, double side) {
  std::vector<Vec3> points;
  for (const Foot& f : feet) points.push_back(f.place);
  const KdTree tree(points);
  Facts facts;
  facts.spacing = side;
  facts.diagonal = 3;
  std::vector<Level> levels(1);
  levels[0].certificate = compare(mesh, tree).certificate;
  levels[0].confidence.assign(mesh.vertices.size(), 1);
  levels[0].mesh = std::move(mesh);
  CloudSupport support;
  measure_support(levels, {points, tree, facts}, support);
  return support;
}

TEST(Unfaced, NumbersAreThoseOf20000PointsHoweverManyThereAre) {
  for (const double side : {spacing, spacing / 2}) {
    std::vector<Foot> feet = feet_on_slab(side);
    erase_rim(feet);
    const double measured_with = feet.size() / std::floor(feet.size() / 20000.0);
    EXPECT_NEAR(support_of(slab(), feet, side).unfaced_points, 500 * measured_with / 21500, 40) << side;
  }
}

TEST(Unfaced, TheEndsOfAnOpenSurfaceAreOpen) {
  std::vector<Foot> feet = feet_on_slab();
  erase_rim(feet);
  TriMesh mesh = slab();
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return std::all_of(t.begin(), t.end(), [&](auto v) { return mesh.vertices[v].x() < -0.999; });
  });
  EXPECT_EQ(support_of(std::move(mesh), feet, spacing).unfaced_points, 0);
}

TEST(Unfaced, ACutPlateIsToldAndShownAndAWholeOneIsNot) {
  PointCloud cloud = synthetic::make_cloud({.shape = synthetic::CloudShape::plate, .points = 20000});
  Options options;
  options.triangles = {5120};
  const Result whole = reconstruct(cloud, options);
  EXPECT_LT(whole.support.unfaced_points, 5);
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points) box.extend(p);
  const double cut = box.center().x() + 0.3 * box.sizes().x();
  std::erase_if(cloud.points, [&](const Vec3& p) { return p.x() > cut; });

  const Result result = reconstruct(cloud, options);
  EXPECT_EQ(verdict_of(result), Verdict::check);
  EXPECT_TRUE(std::any_of(result.notes.begin(), result.notes.end(),
                          [](const Note& n) { return n.code == "cloud.cut_off" && n.severity == Severity::warning; }));
  EXPECT_LT(result.support.made_up, 0.01);  // which told nothing
  const Level& level = result.levels[0];
  for (std::size_t v = 0; v < level.mesh.vertices.size(); ++v)
    if (level.confidence[v] < 1) {
      EXPECT_GT(level.mesh.vertices[v].x(), cut - 0.05 * box.sizes().x());
    }
  EXPECT_LT(*std::min_element(level.confidence.begin(), level.confidence.end()), 0.8f);
}

}  // namespace
}  // namespace dynasurf::cloud
