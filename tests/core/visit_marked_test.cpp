#include "dynasurf/core/detail/visit_marked.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

TEST(VisitMarked, TellsEachMarkedVoxelOfASliceOnceInItsOrder) {
  using Pixel = std::pair<int, int>;
  for (const int width : {1, 7, 16, 33}) {  // less than a vector, whole ones, and more
    Grid g;
    g.dims = {width, 5, 3};
    Mask m(g);
    for (std::size_t v = 0; v < m.values.size(); v += 3) m.values[v] = v % 2 + 1;
    for (const int bit : {1, 2}) {
      const auto is_marked = [bit](std::uint8_t voxel) { return (voxel & bit) != 0; };
      for (int k = 0; k < 3; ++k) {
        std::vector<Pixel> all, visited;
        for (int j = 0; j < 5; ++j)
          for (int i = 0; i < width; ++i)
            if (is_marked(m(i, j, k))) all.emplace_back(i, j);
        visit_marked(m, k, is_marked, [&](int i, int j) { visited.emplace_back(i, j); });
        EXPECT_EQ(visited, all) << width << ' ' << bit << ' ' << k;
      }
    }
  }
}

TEST(VisitMarked, LetsTheVisitClearTheVoxel) {
  Grid g;
  g.dims = {4, 3, 1};
  Mask m(g);
  m.values = {1, 1, 0, 1, 0, 0, 0, 0, 1, 1, 1, 1};
  int visits = 0;
  visit_marked(
      m, 0, [](std::uint8_t voxel) { return voxel != 0; }, [&](int i, int j) { m(i, j, 0) = 0, ++visits; });
  EXPECT_EQ(visits, 7);
  EXPECT_EQ(std::count(m.values.begin(), m.values.end(), 1), 0);
}

}  // namespace
}  // namespace dynasurf
