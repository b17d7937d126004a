#include "dynasurf/ventricle/labels/detail/mlc.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "support/blurred_heart.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr std::uint8_t endo = Labels::endo_bit, epi = Labels::epi_bit;
const Axis middle{31.5, 31.5, 0, 0};

Grid grid_of(int slices) {
  Grid g;
  g.dims = {64, 64, slices};
  return g;
}

image::Component arc(double radius, int slice, double from_deg = -180, double to_deg = 180) {
  image::Component c{slice, {}};
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const double angle = std::atan2(j - 31.5, i - 31.5) * 180 / std::numbers::pi;
      if (std::abs(std::hypot(i - 31.5, j - 31.5) - radius) <= 0.5 && angle >= from_deg && angle <= to_deg)
        c.pixels.push_back({i, j});
    }
  return c;
}

SliceEdges edges_in_slices(const std::vector<image::Component>& edges, int slices) {
  SliceEdges all(static_cast<std::size_t>(slices));
  for (const image::Component& e : edges) all[static_cast<std::size_t>(e.slice)].push_back(e);
  return all;
}

/// The bits of an edge; 255 when its pixels do not agree.
int bits(const Mask& m, const image::Component& c) {
  const int first = m(c.pixels[0].i, c.pixels[0].j, c.slice);
  for (const image::Pixel& p : c.pixels)
    if (m(p.i, p.j, c.slice) != first) return 255;
  return first;
}

TEST(ClassifyByGap, PutsTheFrontierIntoTheLargestGap) {
  const std::vector<image::Component> edges{arc(7, 0, -180, 0), arc(8, 0, 10, 170), arc(14, 0, -170, 0),
                                            arc(15.5, 0, 10, 170)};
  const Mask m = classify_by_gap(edges_in_slices(edges, 1), grid_of(1), middle, -1, Mlc{});
  EXPECT_EQ(bits(m, edges[0]), endo);
  EXPECT_EQ(bits(m, edges[1]), endo);
  EXPECT_EQ(bits(m, edges[2]), epi);
  EXPECT_EQ(bits(m, edges[3]), epi);
}

TEST(ClassifyByGap, CallsEverythingOuterUpToTheDivisionSlice) {
  const std::vector<image::Component> edges{arc(4, 0), arc(10, 0), arc(4, 1), arc(10, 1)};
  const Mask m = classify_by_gap(edges_in_slices(edges, 2), grid_of(2), middle, 0, Mlc{});
  EXPECT_EQ(bits(m, edges[0]), epi);
  EXPECT_EQ(bits(m, edges[2]), endo);
}

TEST(ClassifyByGap, AsksTheNeighboursAboutALoneEdge) {
  const std::vector<image::Component> edges{arc(7, 0), arc(14, 0), arc(7.4, 1), arc(7, 2), arc(14, 2), arc(13.7, 3)};
  const Mask m = classify_by_gap(edges_in_slices(edges, 4), grid_of(4), middle, -1, Mlc{});
  EXPECT_EQ(bits(m, edges[2]), endo);
  EXPECT_EQ(bits(m, edges[5]), epi);
  const Mask strict = classify_by_gap(edges_in_slices(edges, 4), grid_of(4), middle, -1, Mlc{.strict_thesis = true});
  EXPECT_EQ(bits(strict, edges[2]), epi);
}

TEST(ClassifyByGap, KeepsFragmentsOfOneBorderTogether) {
  const std::vector<image::Component> edges{arc(7, 0), arc(14, 0), arc(13.2, 1, -170, -10), arc(14.6, 1, 10, 170)};
  const Mask m = classify_by_gap(edges_in_slices(edges, 2), grid_of(2), middle, -1, Mlc{});
  EXPECT_EQ(bits(m, edges[2]), epi);
  EXPECT_EQ(bits(m, edges[3]), epi);
  const Mask strict = classify_by_gap(edges_in_slices(edges, 2), grid_of(2), middle, -1, Mlc{.strict_thesis = true});
  EXPECT_EQ(bits(strict, edges[2]), endo);  // the published rule always divides
}

TEST(ClassifyByGap, CallsALoneEdgeWithoutNeighboursOuter) {
  const image::Component lone = arc(9, 1);
  EXPECT_EQ(bits(classify_by_gap(edges_in_slices({lone}, 3), grid_of(3), middle, -1, Mlc{}), lone), epi);
}

/// A bright ring of the given radii around the middle of every slice.
Image ring(double inner, double outer, int slices) {
  Image m(grid_of(slices));
  for (int k = 0; k < slices; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 64; ++i) {
        const double d = std::hypot(i - 31.5, j - 31.5);
        m(i, j, k) = d >= inner && d < outer ? 1.0F : 0.0F;
      }
  return m;
}

TEST(SplitByGradient, CutsAnEdgeThatRunsAroundAnOpenWall) {
  // The two borders and the ends of a horseshoe are one component.
  image::Component horseshoe{0, {}};
  for (const image::Component& part : {arc(8, 0, -120, 120), arc(14, 0, -120, 120)})
    horseshoe.pixels.insert(horseshoe.pixels.end(), part.pixels.begin(), part.pixels.end());
  std::sort(horseshoe.pixels.begin(), horseshoe.pixels.end(),
            [](const image::Pixel& a, const image::Pixel& b) { return std::tie(a.j, a.i) < std::tie(b.j, b.i); });
  const SidedEdges sided = split_by_gradient(edges_in_slices({horseshoe}, 1), ring(8, 14, 1), middle, 8);
  ASSERT_EQ(sided.endo[0].size(), 1U);
  ASSERT_EQ(sided.epi[0].size(), 1U);
  EXPECT_EQ(sided.endo[0][0].pixels.size(), arc(8, 0, -120, 120).pixels.size());
  EXPECT_EQ(sided.epi[0][0].pixels.size(), arc(14, 0, -120, 120).pixels.size());
  EXPECT_EQ(join(sided)[0].size(), 2U);
}

TEST(ClassifyByGradient, DropsInnerSidesOutsideTheHeart) {
  // Beside the heart lies a bright blob: the side of it that faces the heart brightens outwards, as the cavity does.
  const image::Component inner = arc(8, 0), outer = arc(14, 0), blob_near = arc(19, 0, -20, 20),
                         blob_far = arc(25, 0, -20, 20);
  Notes notes;
  const SidedEdges sided{edges_in_slices({inner, blob_near}, 1), edges_in_slices({outer, blob_far}, 1)};
  const Mask m = classify_by_gradient(sided, grid_of(1), middle, 4, notes);
  EXPECT_EQ(bits(m, inner), endo);
  EXPECT_EQ(bits(m, outer), epi);
  EXPECT_EQ(bits(m, blob_near), 0);
  EXPECT_EQ(bits(m, blob_far), 0);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].code, "mlc.outliers");
}

TEST(ClassifyByGradient, DropsOuterSidesInsideTheCavity) {
  // Noise in the cavity: a small bright arc has a side that darkens outwards.
  const image::Component inner = arc(10, 0), outer = arc(16, 0), noise = arc(5, 0, 0, 90);
  Notes notes;
  const Mask m = classify_by_gradient({edges_in_slices({inner}, 1), edges_in_slices({outer, noise}, 1)}, grid_of(1),
                                      middle, 4, notes);
  EXPECT_EQ(bits(m, outer), epi);
  EXPECT_EQ(bits(m, noise), 0);
}

TEST(CountBorders, WantsTheInnerBorderToBeARing) {
  Mask m(grid_of(2));
  for (const image::Pixel& p : arc(6, 0, -60, 60).pixels) m(p.i, p.j, 0) = endo;
  for (const image::Pixel& p : arc(12, 0).pixels) m(p.i, p.j, 0) = epi;
  EXPECT_EQ(count_borders(m, 0, middle, 180), 1);
  EXPECT_EQ(count_borders(m, 0, middle, 0), 2);
  EXPECT_EQ(count_borders(m, 1, middle, 0), 0);
  EXPECT_EQ(pixels_of(m, 0, endo).size(), arc(6, 0, -60, 60).pixels.size());
}

}  // namespace
}  // namespace dynasurf::ventricle
