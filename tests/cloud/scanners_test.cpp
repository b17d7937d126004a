#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "dynasurf/cloud/detail/orient.hpp"
#include "dynasurf/cloud/detail/prepare.hpp"
#include "dynasurf/cloud/detail/triangle_marks.hpp"
#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::cloud {
namespace {

/// Points of what a scanner sees, each with the direction of the side that it sees.
struct Seen {
  PointCloud cloud;
  std::vector<Vec3> truth;
};

/// The lower half of a sphere, from within.
Seen bowl(double noise = 0) {
  synthetic::Random random(3);
  Seen seen;
  while (seen.truth.size() < 8000) {
    const Vec3 way = Vec3(random.normal(), random.normal(), -std::abs(random.normal())).normalized();
    seen.cloud.points.push_back((1 + noise * random.normal()) * way);
    seen.truth.push_back(-way);
  }
  seen.cloud.scanners = {Vec3(0.1, 0.2, 0.3)};
  return seen;
}

/// Five sides of a box; `side` 1: from without, -1: from within.
void add_box(Seen& seen, const Vec3& low, const Vec3& high, int without, double side, std::size_t points) {
  synthetic::Random random(9);
  const Vec3 size = high - low;
  for (int face = 0; face < 6; ++face) {
    if (face == without) continue;
    const int axis = face / 2, other = (axis + 1) % 3, third = (axis + 2) % 3;
    const double share = size[other] * size[third] / (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
    for (std::size_t n = static_cast<std::size_t>(share * static_cast<double>(points)); n > 0; --n) {
      Vec3 p = low + size.cwiseProduct(Vec3(random.uniform(), random.uniform(), random.uniform()));
      p[axis] = face % 2 == 0 ? low[axis] : high[axis];
      seen.cloud.points.push_back(p);
      seen.truth.push_back((face % 2 == 0 ? -side : side) * Vec3::Unit(axis));
    }
  }
}

/// A room of 4 x 3 x 2.5 m without a ceiling and a cupboard in it, from two places. A point is of the first that sees
/// the side it is on.
Seen room() {
  Seen seen;
  add_box(seen, {0, 0, 0}, {4, 3, 2.5}, 5, -1, 12000);
  add_box(seen, {1.6, 1.2, 0.3}, {2.4, 1.8, 1.2}, 4, 1, 3000);
  seen.cloud.scanners = {Vec3(0.8, 0.7, 1.6), Vec3(3.2, 2.3, 1.6)};
  for (std::size_t n = 0; n < seen.truth.size(); ++n) {
    const Vec3 to = seen.cloud.scanners[0] - seen.cloud.points[n];
    seen.cloud.scans.push_back(seen.truth[n].dot(to) > 0 ? 0 : 1);
  }
  return seen;
}

double share_right(const OrientedPoints& o, const std::vector<Vec3>& truth) {
  std::size_t right = 0;
  for (std::size_t n = 0; n < truth.size(); ++n) right += o.normals[n].dot(truth[n]) > 0;
  return static_cast<double>(right) / static_cast<double>(truth.size());
}

TEST(Scanners, TurnABowlToWhereItWasSeenFrom) {
  for (const double noise : {0.0, 0.01}) {
    Seen seen = bowl(noise);
    const double most = noise > 0 ? 0.99 : 1;  // which tilts the planes of some points at the rim
    EXPECT_GE(share_right(orient(seen.cloud, false), seen.truth), most);
    EXPECT_TRUE(orient(seen.cloud, false).is_seen);
    seen.cloud.scanners.clear();
    EXPECT_LE(share_right(orient(seen.cloud, false), seen.truth), 1 - most) << "its outermost points face outwards";
    EXPECT_FALSE(orient(seen.cloud, false).is_seen);
  }
}

TEST(Scanners, TurnWallsInwardsAndWhatStandsInTheRoomOutwards) {
  Seen seen = room();
  // Along the edges the plane of a point may belong to either side.
  EXPECT_GT(share_right(orient(seen.cloud, false), seen.truth), 0.98);
  PointCloud unknown = seen.cloud;
  unknown.scanners.clear();
  EXPECT_LT(share_right(orient(unknown, false), seen.truth), 0.5);
  // Thinned points know their scans.
  const PointCloud thin = voxel_downsample(seen.cloud, 0.08);
  ASSERT_EQ(thin.scans.size(), thin.points.size());
  const OrientedPoints o = orient(thin, false);
  std::size_t inwards = 0, walls = 0;
  for (std::size_t n = 0; n < o.points.size(); ++n) {
    if (o.points[n][0] > 0.01 || o.points[n][2] < 0.2 || std::abs(o.points[n][1] - 1.5) > 1.3) continue;
    ++walls;
    inwards += o.normals[n][0] > 0.9;
  }
  EXPECT_GT(walls, 100u);
  EXPECT_EQ(inwards, walls);
}

TEST(Scanners, SayNothingWhereTheyContradictEachOther) {
  Seen seen = bowl();
  const std::vector<Vec3> alone = [&] {
    PointCloud cloud = seen.cloud;
    cloud.scanners.clear();
    return orient(cloud, false).normals;
  }();
  PointCloud both = seen.cloud;
  both.scanners = {Vec3(0, 0, 0.1), Vec3(0, 0, -9)};
  for (std::uint32_t n = 0; n < both.points.size(); ++n) both.scans.push_back(n % 2);
  EXPECT_EQ(orient(both, false).normals, alone);
  PointCloud unknown = seen.cloud;
  unknown.scanners = {Vec3::Constant(std::numeric_limits<double>::quiet_NaN())};
  EXPECT_EQ(orient(unknown, false).normals, alone);
  // One scan of two is enough.
  unknown.scans = both.scans;
  unknown.scanners.push_back(Vec3(0, 0, 0.1));
  EXPECT_EQ(share_right(orient(unknown, false), seen.truth), 1);
}

TEST(Scanners, DoNotTurnNormalsThatAreGiven) {
  Seen seen = bowl();
  for (const Vec3& n : seen.truth) seen.cloud.normals.push_back(-n);
  EXPECT_EQ(share_right(orient(seen.cloud, true), seen.truth), 0);
  EXPECT_EQ(share_right(orient(seen.cloud, false), seen.truth), 1);
}

TEST(Scanners, AreToldForEachScan) {
  PointCloud cloud = bowl().cloud;
  cloud.scans.assign(cloud.points.size(), 1);
  EXPECT_THROW(prepare(cloud, {}), InputError);
  cloud.scans.back() = 0;
  cloud.scanners.push_back(Vec3(0, 0, 0));
  EXPECT_NO_THROW(prepare(cloud, {}));
}

TEST(Scanners, LeaveAnOpenSurfaceFacingThem) {
  Options options;
  options.triangles = {800};
  options.boundary = BoundaryRule::keep;
  for (const bool known : {true, false}) {
    PointCloud cloud = bowl().cloud;
    if (!known) cloud.scanners.clear();
    const Result result = reconstruct(cloud, options);
    EXPECT_TRUE(result.levels[0].certificate.sound_open());
    EXPECT_NEAR(facing_of(result.levels[0].mesh)[2], known ? 0.5 : -0.5, 0.05);
  }
}

TEST(Scanners, LeaveAClosedBodyOutwards) {
  Seen seen;
  add_box(seen, {0, 0, 0}, {4, 3, 2.5}, -1, -1, 12000);
  seen.cloud.scanners = {Vec3(2, 1.4, 1.2)};
  Options options;
  options.triangles = {1280};
  const Result result = reconstruct(seen.cloud, options);
  const Certificate& c = result.levels[0].certificate;
  EXPECT_TRUE(c.watertight());
  EXPECT_NEAR(c.volume, 4 * 3 * 2.5, 0.5);
  EXPECT_LT(c.cloud_to_mesh_mean, 0.01);
  for (const Note& note : result.notes) EXPECT_NE(note.severity, Severity::warning) << note.message;
}

TEST(Scanners, GiveTheSameBytesOnAnyNumberOfThreads) {
  const PointCloud cloud = room().cloud;
  const ThreadLimit one(1);
  const std::vector<Vec3> alone = orient(cloud, false).normals;
  const ThreadLimit three(3);
  EXPECT_EQ(orient(cloud, false).normals, alone);
}

}  // namespace
}  // namespace dynasurf::cloud
