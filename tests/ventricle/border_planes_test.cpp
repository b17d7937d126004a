#include "dynasurf/ventricle/detail/border_planes.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/ventricle/detail/closure.hpp"
#include "dynasurf/ventricle/label_borders.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double middle = 20.3, radius_px = 9.4;  // nothing lies on a pixel

/// A disc whose edge is blurred: the gradient is largest exactly at `radius_px`.
Image blurred_disc() {
  Grid grid;
  grid.dims = {41, 41, 5};
  grid.spacing = {2, 2, 4};
  Image image(grid);
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 41; ++j)
      for (int i = 0; i < 41; ++i)
        image(i, j, k) =
            static_cast<float>(0.5 * std::erfc(std::hypot(i - middle, j - middle) / 1.5 - radius_px / 1.5));
  return image;
}

struct Case {
  image::EdgeMap edges;
  Labels labels;
  Image border;
};

Case disc_case() {
  Case c;
  c.edges = image::detect_edges(blurred_disc(), image::Canny{});
  c.labels.borders = c.edges.edges;
  for (auto& v : c.labels.borders.values) v = v != 0 ? Labels::epi_bit : std::uint8_t{0};
  c.labels.axis = {middle, middle, 0, 0};
  c.border = close_border(border_volume(c.labels, Border::epi), 4);
  return c;
}

dynamics::BorderPlane plane_at(const dynamics::BorderPlanes& border, const Index3& v) {
  return plane_in(border, border.grid.index(v[0], v[1], v[2]));
}
Vec3 offset_at(const dynamics::BorderPlanes& border, const Index3& v) {
  return plane_at(border, v).offset.cast<double>();
}
Vec3 normal_at(const dynamics::BorderPlanes& border, const Index3& v) {
  return plane_at(border, v).normal.cast<double>();
}

TEST(BorderPlanes, FindTheEdgeInsideItsPixels) {
  const Case c = disc_case();
  const dynamics::BorderPlanes planes = border_planes(c.border, Border::epi, c.labels, c.edges, 4);
  double with = 0, without = 0;
  int count = 0;
  for (int j = 0; j < 41; ++j)
    for (int i = 0; i < 41; ++i) {
      if (c.labels.borders(i, j, 2) == 0) continue;
      const Vec3 offset = offset_at(planes, {i, j, 2}) / 2;  // px
      with += std::abs(std::hypot(i + offset[0] - middle, j + offset[1] - middle) - radius_px);
      without += std::abs(std::hypot(i - middle, j - middle) - radius_px);
      ++count;
    }
  ASSERT_GT(count, 40);
  EXPECT_LT(with / count, 0.1);      // what the parabola and the extra blur of the detector leave
  EXPECT_GT(without / count, 0.15);  // pixel centres
}

TEST(BorderPlanes, StandSquareToTheRayOnEdgesAndToTheSlicesOnTheClosingDiscs) {
  const Case c = disc_case();
  const dynamics::BorderPlanes planes = border_planes(c.border, Border::epi, c.labels, c.edges, 4);
  const Index3 inside{20, 20, 4}, bottom{20, 20, 0};
  EXPECT_EQ(offset_at(planes, inside), Vec3(0, 0, 2));
  EXPECT_EQ(offset_at(planes, bottom), Vec3(0, 0, -2));
  EXPECT_EQ(normal_at(planes, inside), Vec3(0, 0, 1));
  EXPECT_EQ(normal_at(planes, {20, 20, 2}), Vec3(0, 0, 0)) << "no border voxel";
  for (int i = 0; i < 41; ++i)
    if (c.labels.borders(i, 20, 2) != 0) {
      EXPECT_NEAR(std::abs(normal_at(planes, {i, 20, 2}).normalized()[0]), 1, 0.01);
    }
}

TEST(BorderPlanes, FollowTheBorderOntoALargerGrid) {
  const Case c = disc_case();
  const Image roomy = with_room(c.border, 3);
  ASSERT_EQ(roomy.grid.dims[2], 11);
  const dynamics::BorderPlanes small = border_planes(c.border, Border::epi, c.labels, c.edges, 4);
  const dynamics::BorderPlanes large = border_planes(roomy, Border::epi, c.labels, c.edges, 4);
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 41; ++j)
      for (int i = 0; i < 41; ++i) ASSERT_EQ(offset_at(large, {i, j, k + 3}), offset_at(small, {i, j, k}));
}

}  // namespace
}  // namespace dynasurf::ventricle
