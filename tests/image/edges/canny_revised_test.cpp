#include <gtest/gtest.h>

#include "dynasurf/image/detail/components.hpp"
#include "dynasurf/image/edges.hpp"

#include "support/blurred_heart.hpp"
#include "support/edge_images.hpp"

namespace dynasurf::image {
namespace {

using test::count_set;
using test::image_of;

TEST(CannyRevised, HoldsAllOfCanny) {
  test::HeartShape h;
  h.noise = 0.1, h.dims[2] = 6, h.apex_slice = 0, h.base_slice = 5;
  for (const Image& m : {test::noise_image(50, 50, 2), test::blurred_heart(h)}) {
    const Mask plain = detect_edges(m, Canny{}).edges, revised = detect_edges(m, CannyRevised{}).edges;
    std::size_t minor = 0;
    for (std::size_t n = 0; n < plain.values.size(); ++n) {
      EXPECT_EQ(revised.values[n] == 2, plain.values[n] == 2);
      minor += revised.values[n] == 1;
    }
    EXPECT_GT(minor, 0U);
  }
}

TEST(CannyRevised, ClosesTheGapOfAJunction) {
  // Three regions that meet: the gradient turns at the junction, and the line between the two fainter ones ends before
  // it reaches the bright border.
  for (const double sigma : {0.7, 1.0})
    for (const double middle : {0.45, 0.5, 0.55}) {
      const Image junction = image_of(40, 40, 1, [&](int i, int j, int) {
        return i >= 20 ? 1.0 : j >= 20 ? middle : 0.1;
      });
      const Canny o{.sigma_px = sigma, .low = 0.05, .high = 0.3};
      EXPECT_EQ(components_of_slice(detect_edges(junction, o).edges, 0).size(), 2U);
      EXPECT_EQ(components_of_slice(detect_edges(junction, CannyRevised{o}).edges, 0).size(), 1U);
    }
}

TEST(CannyRevised, AddsNothingToAStraightStep) {
  for (double angle = 0; angle < 360; angle += 11.3) {
    const Image step = test::step_image(40, 19.3, 19.8, angle);
    for (const double sigma : {0.8, 1.4, 2.5}) {
      const Canny o{.sigma_px = sigma};
      const Mask plain = detect_edges(step, o).edges, revised = detect_edges(step, CannyRevised{o}).edges;
      // Where the step leaves the image the replicated border bends it.
      for (int j = 8; j < 32; ++j)
        for (int i = 8; i < 32; ++i) EXPECT_EQ(revised(i, j, 0), plain(i, j, 0)) << angle << " " << sigma;
    }
  }
}

}  // namespace
}  // namespace dynasurf::image
