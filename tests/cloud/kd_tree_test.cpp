#include "dynasurf/cloud/detail/kd_tree.hpp"

#include <algorithm>
#include <array>
#include <random>

#include <gtest/gtest.h>

namespace dynasurf::cloud {
namespace {

std::vector<Vec3> points(int count) {
  std::mt19937 random(7);
  const auto number = [&] { return static_cast<double>(random() % 50); };  // many in the same place or equally near
  std::vector<Vec3> all;
  for (int i = 0; i < count; ++i) {
    const double x = number(), y = number(), z = number();
    all.push_back(Vec3(x, y, z));
  }
  return all;
}

TEST(KdTree, AreThoseThatSortingAllDistancesGives) {
  const std::vector<Vec3> all = points(2000);
  const KdTree neighbours(all);
  for (int n = 0; n < 100; ++n) {
    const Vec3 p = all[static_cast<std::size_t>(n * 17)] + Vec3(0.25 * (n % 3), 0, 0);
    std::vector<KdTree::Found> expected;
    for (std::uint32_t i = 0; i < all.size(); ++i) expected.push_back({(all[i] - p).squaredNorm(), i});
    std::sort(expected.begin(), expected.end());
    std::array<KdTree::Found, 13> found;
    ASSERT_EQ(neighbours.nearest(p, found), 13u);
    for (std::size_t k = 0; k < 13; ++k) {
      EXPECT_EQ(found[k].index, expected[k].index);
      EXPECT_EQ(found[k].distance2, expected[k].distance2);
    }
    EXPECT_EQ(neighbours.nearest(p).index, expected[0].index);
  }
}

TEST(KdTree, EndWhereTheSearchIsToldToEnd) {
  const std::vector<Vec3> all = points(2000);
  const KdTree neighbours(all);
  std::array<KdTree::Found, 13> every, near;
  for (std::size_t n = 0; n < 100; ++n) {
    const Vec3 p = all[n * 17] + Vec3(0.3, 0.1, 0);
    neighbours.nearest(p, every);
    const double within = 4;
    const std::size_t count = neighbours.nearest(p, near, within);
    for (std::size_t k = 0; k < every.size(); ++k) {
      EXPECT_EQ(k < count, every[k].distance2 < within * within);
      if (k < count) {
        EXPECT_EQ(near[k].index, every[k].index);
      }
    }
  }
  EXPECT_EQ(neighbours.nearest(Vec3(1000, 0, 0), 5).distance2, 25);
}

TEST(KdTree, AreFewerInASmallCloudAndNoneInAnEmptyOne) {
  const std::vector<Vec3> three = points(3);
  std::array<KdTree::Found, 5> found;
  EXPECT_EQ(KdTree(three).nearest(Vec3::Zero(), found), 3u);
  EXPECT_EQ(KdTree(std::vector<Vec3>{}).nearest(Vec3::Zero(), found), 0u);
}

TEST(KdTree, CopeWithPointsAllInOnePlace) {
  const std::vector<Vec3> same(100, Vec3(1, 2, 3));
  std::array<KdTree::Found, 5> found;
  EXPECT_EQ(KdTree(same).nearest(Vec3(1, 2, 4), found), 5u);
  EXPECT_EQ(found[4].index, 4u);
}

TEST(KdTree, StayThoseOfTheOthersWhenSomePointsAreForgotten) {
  std::vector<Vec3> all = points(2000), rest;
  std::vector<std::uint32_t> had;
  KdTree fewer(all, had);
  std::vector<std::uint8_t> kept(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    kept[i] = i % 3 != 1;
    if (kept[i]) rest.push_back(all[i]);
  }
  fewer.keep(kept, rest);
  const KdTree fresh(rest);
  std::array<KdTree::Found, 9> found, expected;
  for (const Vec3& p : all) {
    ASSERT_EQ(fewer.nearest(p, found), fresh.nearest(p, expected));
    for (std::size_t k = 0; k < found.size(); ++k) ASSERT_EQ(found[k].index, expected[k].index);
  }
}

TEST(KdTree, OfReorderedPointsNumbersThemAsTheyStand) {
  const std::vector<Vec3> all = points(500);
  std::vector<Vec3> reordered = all;
  std::vector<std::uint32_t> had;
  const KdTree tree(reordered, had);
  EXPECT_EQ(tree.points().data(), reordered.data());
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(tree.number(i), i);
    EXPECT_EQ(reordered[i], all[had[i]]);
  }
}

}  // namespace
}  // namespace dynasurf::cloud
