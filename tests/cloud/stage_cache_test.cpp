#include "dynasurf/cloud/stage_cache.hpp"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

#include "support/option_changes.hpp"

namespace dynasurf::cloud {
namespace {

/// A scan with strays, some of which stay where few are left out.
PointCloud scan_of(const char* shape) {
  synthetic::CloudPhantom phantom;
  phantom.points = 2000;
  set_option(phantom, std::string("shape=") + shape);
  PointCloud cloud = synthetic::make_cloud(phantom);
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points) box.extend(p);
  synthetic::Random random(1);
  for (int n = 0; n < 30; ++n) {
    const Vec3 share{random.uniform(), random.uniform(), random.uniform()};
    cloud.points.push_back(box.center() + 2 * (share - Vec3::Constant(0.5)).cwiseProduct(box.sizes()));
  }
  return cloud;
}

bool is_same(const Result& a, const Result& b) {
  if (a.levels.size() != b.levels.size() || a.notes != b.notes || a.used != b.used) return false;
  for (std::size_t n = 0; n < a.levels.size(); ++n)
    if (a.levels[n].mesh != b.levels[n].mesh || a.levels[n].errors != b.levels[n].errors ||
        a.levels[n].confidence != b.levels[n].confidence)
      return false;
  return a.support.firm == b.support.firm && a.support.turned == b.support.turned && a.support.cell == b.support.cell &&
         a.facts.noise == b.facts.noise && a.facts.cells == b.facts.cells && a.facts.genus == b.facts.genus;
}

/// The stages that progress tells of while a result is made with this cache, which must be the one made without.
std::string stages_of(const PointCloud& cloud, const Options& options, StageCache& cache) {
  std::string stages;
  const Progress told{[&](std::string_view stage, int, int) {
                        if (!stages.ends_with(stage)) stages += stages.empty() ? stage : ' ' + std::string(stage);
                      },
                      {}};
  EXPECT_TRUE(is_same(reconstruct(cloud, options, told, &cache), reconstruct(cloud, options)));
  return stages;
}

TEST(StageCache, EveryOptionHasItsEffect) {
  const PointCloud cloud = scan_of("torus");
  Options options;
  options.triangles = {320, 160};
  StageCache cache;
  std::vector<std::string> changes = test::a_change_of_every_option(options);
  EXPECT_GT(changes.size(), 10U);
  for (const char* list : {"triangles=2560,320", "boundary=keep", "boundary=trim", "start=hull"})
    changes.emplace_back(list);
  for (const std::string& change : changes) {
    Options changed = options;
    set_option(changed, change);
    SCOPED_TRACE(change);
    try {
      check(changed);
    } catch (const OptionError&) {
      continue;
    }
    reconstruct(cloud, options, {}, &cache);
    stages_of(cloud, changed, cache);
  }
}

TEST(StageCache, DoesAgainWhatAChangeTouches) {
  const PointCloud cloud = scan_of("vase");
  Options options;
  options.triangles = {320, 160};
  StageCache cache;
  const std::string all = stages_of(cloud, options, cache);
  EXPECT_EQ(all, "points inside levels");
  options.triangles = {320, 80};
  EXPECT_EQ(stages_of(cloud, options, cache), "points levels");
  options.genus = GenusRule::keep;
  EXPECT_EQ(stages_of(cloud, options, cache), all);
}

// Scanners write no numbers where they saw nothing, and not every file tells a scanner's place.
TEST(StageCache, KnowsACloudAgainWhatIsNotKnownOfIt) {
  PointCloud cloud = scan_of("vase");
  const Vec3 unknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  cloud.points.push_back(unknown);
  cloud.scans.assign(cloud.points.size(), 0);
  cloud.scanners = {unknown};
  Options options;
  options.triangles = {320, 160};
  StageCache cache;
  stages_of(cloud, options, cache);
  options.triangles = {320, 80};
  EXPECT_EQ(stages_of(cloud, options, cache), "points levels");
  cloud.scanners = {Vec3::Zero()};
  EXPECT_EQ(stages_of(cloud, options, cache), "points inside levels");
}

TEST(StageCache, ForgetsAnotherCloud) {
  Options options;
  options.triangles = {320};
  StageCache cache;
  for (const char* shape : {"vase", "spring", "vase"}) stages_of(scan_of(shape), options, cache);
}

}  // namespace
}  // namespace dynasurf::cloud
