#include "dynasurf/ventricle/label_borders.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"

#include "support/blurred_heart.hpp"
#include "support/notes.hpp"

namespace dynasurf::ventricle {
namespace {

using test::has_code;
using test::HeartShape;

Labels labels_of(const Image& image, const Labelling& options = {}, const image::Canny& edges = {}) {
  return label_borders(image, image::detect_edges(image, edges), options);
}

/// How the labelled voxels of one border agree with the truth.
struct Score {
  int voxels = 0, wrong = 0;  // wrong: nearer to the other border
  double error_px = 0;        // mean distance from the true border
  int slices_missing = 0;     // of those where the border exists by more than a slice and is 3 px wide or more
};

Score score(const Labels& labels, const HeartShape& h, Border wall) {
  Score s;
  const std::uint8_t bit = wall == Border::endo ? Labels::endo_bit : Labels::epi_bit;
  for (int k = 0; k < h.dims[2]; ++k) {
    int here = 0;
    const double own = test::true_radius_px(h, k, wall == Border::epi),
                 other = test::true_radius_px(h, k, wall != Border::epi);
    for (int j = 0; j < h.dims[1]; ++j)
      for (int i = 0; i < h.dims[0]; ++i) {
        if (!(labels.borders(i, j, k) & bit)) continue;
        ++here;
        const double d = std::hypot(i - test::centre_x(h, k), j - test::centre_y(h, k));
        s.wrong += own > 0 && other > 0 && std::abs(d - other) < std::abs(d - own);
        s.error_px += own > 0 ? std::abs(d - own) : 0;
      }
    s.voxels += here;
    const bool expected = own > 3 && k < h.base_slice - 1 && test::true_radius_px(h, k - 1, wall == Border::epi) > 0;
    s.slices_missing += expected && here == 0;
  }
  s.error_px /= std::max(1, s.voxels);
  return s;
}

/// The true division slice: the highest that the cavity does not reach.
int true_division(const HeartShape& h) {
  int k = 0;
  while (k + 1 < h.dims[2] && test::true_radius_px(h, k + 1, false) == 0) ++k;
  return k;
}

TEST(Labels, OfASharpHeartAreAllRight) {
  HeartShape h;
  h.fwhm_mm = 3;
  for (const bool gradient : {true, false}) {
    Labelling o;
    std::get<Mlc>(o.method).use_gradient = gradient;
    const Labels labels = labels_of(test::blurred_heart(h), o);
    for (const Border wall : {Border::endo, Border::epi}) {
      const Score s = score(labels, h, wall);
      EXPECT_GT(s.voxels, 300);
      EXPECT_EQ(s.wrong, 0) << name_of(wall);
      EXPECT_EQ(s.slices_missing, 0) << name_of(wall);
      EXPECT_LT(s.error_px, 0.6) << name_of(wall);  // half a pixel of rounding, and the plateau rule
    }
    EXPECT_NEAR(labels.circle.x_px, 31.5, 0.2);
    // The base is the widest slice; blur at the open end may make the one below it look wider.
    EXPECT_NEAR(labels.big_slice, h.base_slice - 1, 1.01);
    EXPECT_NEAR(labels.circle.radius_px - 2, test::true_radius_px(h, labels.big_slice, true), 1);
    EXPECT_NEAR(labels.division_slice, true_division(h), 1);
    EXPECT_FALSE(has_code(labels.notes, "labels.endo_missing"));
  }
}

struct Hard {
  const char* name;
  HeartShape shape;
};
void PrintTo(const Hard& h, std::ostream* out) { *out << h.name; }

class HardHeart : public testing::TestWithParam<Hard> {};

TEST_P(HardHeart, GivesNoFragmentToTheWrongWall) {
  const HeartShape& h = GetParam().shape;
  const Labels labels = labels_of(test::blurred_heart(h));
  for (const Border wall : {Border::endo, Border::epi}) {
    const Score s = score(labels, h, wall);
    EXPECT_GT(s.voxels, wall == Border::endo ? 80 : 250) << name_of(wall);
    EXPECT_LE(s.wrong, 0.02 * s.voxels) << name_of(wall);
    EXPECT_EQ(s.slices_missing, 0) << name_of(wall);
    // The steepest slope of a blurred wall lies off its border by a share of the blur that grows with curvature and
    // thinness; a third of the FWHM holds for all of these walls, half a pixel is the rounding.
    EXPECT_LT(s.error_px, h.fwhm_mm / h.spacing[0] / 3 + 0.5) << name_of(wall);
  }
  EXPECT_NEAR(labels.division_slice, true_division(h), 1);
}

const std::vector<Hard> hard_hearts{
    {"blurred", {}},
    {"noisy", {.noise = 0.06}},
    {"very_blurred", {.fwhm_mm = 16, .noise = 0.03}},
    {"small_cavity", {.epi_radius_mm = 30, .wall_mm = 14, .apex_wall_mm = 14, .noise = 0.03}},
    {"wide", {.x_px = 30, .y_px = 33, .epi_radius_mm = 48, .noise = 0.04}},
    {"off_centre", {.x_px = 25, .y_px = 38, .noise = 0.03}},
    {"tilted", {.tilt_x_px = 0.5, .tilt_y_px = -0.3, .noise = 0.03}},
    {"open_wall", {.noise = 0.03, .defect_deg = 80}},
    {"defect_of_the_apex", {.noise = 0.03, .defect_deg = 120, .defect_to_slice = 9}},
    {"gut", {.noise = 0.03, .blobs = {{31, 54, 10, 16, 1.2}}}},
    {"gut_at_the_wall", {.noise = 0.03, .blobs = {{32, 49.5, 9, 12, 0.9}}}},
    {"large_voxels",
     {.dims = {32, 32, 14},
      .spacing = {5.4, 5.4, 5.4},
      .x_px = 15.5,
      .y_px = 15.5,
      .apex_slice = 2,
      .base_slice = 11,
      .noise = 0.03}},
    {"small_voxels",
     {.dims = {128, 128, 30},
      .spacing = {1.6, 1.6, 4},
      .x_px = 63,
      .y_px = 64,
      .apex_slice = 4,
      .base_slice = 24,
      .noise = 0.03}},
};
INSTANTIATE_TEST_SUITE_P(All, HardHeart, testing::ValuesIn(hard_hearts), [](const auto& p) { return p.param.name; });

TEST(Labels, MoveWithTheImage) {
  HeartShape h;
  h.noise = 0.03;
  const Image image = test::blurred_heart(h);
  Labelling o, moved;
  o.coarse = {.x_px = 31.5, .y_px = 31.5, .radius_px = 22};
  moved.coarse = {.x_px = 34.5, .y_px = 29.5, .radius_px = 22};
  const Labels at = labels_of(image, o), there = labels_of(test::shifted(image, 3, -2), moved);
  EXPECT_EQ(there.borders.values, test::shifted(at.borders, 3, -2).values);
  EXPECT_EQ(there.division_slice, at.division_slice);
}

TEST(Labels, TurnWithTheImage) {
  HeartShape h;
  h.noise = 0.03, h.defect_deg = 70;
  const Image image = test::blurred_heart(h);
  EXPECT_EQ(labels_of(test::quarter_turn(image)).borders.values, test::quarter_turn(labels_of(image).borders).values);
}

TEST(Labels, AreTheSameForAnyNumberOfThreads) {
  HeartShape h;
  h.noise = 0.05;
  const Image image = test::blurred_heart(h);
  std::vector<std::uint8_t> reference;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    const Labels labels = labels_of(image);
    if (threads == 1) reference = labels.borders.values;
    EXPECT_EQ(labels.borders.values, reference) << threads;
  }
}

TEST(Labels, FollowThePublishedRuleWhenAsked) {
  HeartShape h;
  h.fwhm_mm = 3;
  Labelling o;
  o.circle.robust_fit = false;
  o.method = Mlc{.strict_thesis = true, .box_margin_px = 0};
  const Labels labels = labels_of(test::blurred_heart(h), o);
  for (const Border wall : {Border::endo, Border::epi}) EXPECT_EQ(score(labels, h, wall).wrong, 0) << name_of(wall);
  EXPECT_EQ(labels.axis.dx_px, 0);
}

TEST(Labels, FollowTheCavityDownPastABrightTip) {
  // The centre brightens where the cavity is still seen as a ring: both its borders are kept there.
  HeartShape h;
  const Image image = test::blurred_heart(h);
  const image::EdgeMap edges = image::detect_edges(image, image::Canny{});
  Labelling late;
  late.division.jump = 0.04;  // any rise will do: the profile alone ends the cavity early
  late.division.floor = 0;
  const Labels labels = label_borders(image, edges, late);
  const auto note = std::find_if(labels.notes.begin(), labels.notes.end(),
                                 [](const Note& n) { return n.code == "slice_find.lowered"; });
  ASSERT_NE(note, labels.notes.end());
  EXPECT_EQ(labels.division_slice, label_borders(image, edges, {}).division_slice);
  EXPECT_NEAR(labels.division_slice, true_division(h), 1);
  EXPECT_FALSE(has_code(labels.notes, "slice_refine.case_8"));
}

TEST(Labels, EndTheCavityAtItsTipThoughBlurHidesIt) {
  // Thin slices, so that one slice is a few millimetres: the inner border alone ends two to four of them too high.
  for (const double fwhm : {8.0, 16.0})
    for (const double radius : {28.0, 48.0}) {
      HeartShape h;
      h.dims = {64, 64, 34}, h.spacing[2] = 3.5, h.apex_slice = 6, h.base_slice = 28;
      h.fwhm_mm = fwhm, h.epi_radius_mm = radius, h.noise = 0.03;
      const Labels labels = labels_of(test::blurred_heart(h));
      EXPECT_NEAR(labels.division_slice, true_division(h), 1) << fwhm << " " << radius;
      EXPECT_FALSE(has_code(labels.notes, "slice_find.dim_tip"));
    }
}

TEST(Labels, SayThatTheApexIsDim) {
  HeartShape h;
  h.defect_deg = 200, h.defect_to_slice = 9;
  const Labels labels = labels_of(test::blurred_heart(h));
  EXPECT_TRUE(has_code(labels.notes, "slice_find.dim_tip"));
  EXPECT_NEAR(labels.division_slice, true_division(h), 1);
}

TEST(Labels, KeepTheRightVentricleOut) {
  // A thin crescent on one side; its outer border darkens outwards as the heart's does.
  HeartShape h;
  h.noise = 0.02;
  for (double angle = 100; angle <= 260; angle += 10)
    for (double k = 7; k < 17; ++k)
      h.blobs.push_back({31.5 + 19 * std::cos(angle * std::numbers::pi / 180),
                         31.5 + 19 * std::sin(angle * std::numbers::pi / 180), k, 4, 0.6});
  const Labels labels = labels_of(test::blurred_heart(h));
  for (const Border wall : {Border::endo, Border::epi}) {
    const Score s = score(labels, h, wall);
    EXPECT_EQ(s.slices_missing, 0) << name_of(wall);
    EXPECT_LE(s.wrong, 0.02 * s.voxels) << name_of(wall);
    EXPECT_LT(s.error_px, h.fwhm_mm / h.spacing[0] / 3 + 0.5) << name_of(wall);
  }
}

TEST(Labels, AreNotMisledByContoursOfNoise) {
  // An arc far out in every third slice, and a bright spot inside the cavity in every fourth.
  HeartShape h;
  h.noise = 0.02;
  Image image = test::blurred_heart(h);
  for (int k = 0; k < 23; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 64; ++i) {
        const double x = i - 31.5, y = j - 31.5, d = std::hypot(x, y) - 20;
        if (k % 3 == 0 && std::abs(std::atan2(y, x)) < 1.7)
          image(i, j, k) += static_cast<float>(0.6 * std::exp(-d * d / 4));
        if (k % 4 == 0 && k >= 9) image(i, j, k) += static_cast<float>(0.5 * std::exp(-(x * x + y * y) / 4));
      }
  const Labels labels = labels_of(image);
  for (const Border wall : {Border::endo, Border::epi}) {
    const Score s = score(labels, h, wall);
    EXPECT_GT(s.voxels, wall == Border::endo ? 300 : 600) << name_of(wall);
    EXPECT_LE(s.wrong, 0.05 * s.voxels) << name_of(wall);  // LAB-MLC's own limit
    EXPECT_EQ(s.slices_missing, 0) << name_of(wall);
  }
}

TEST(Labels, NeverInventAMissingBorder) {
  HeartShape h;
  const Image image = test::blurred_heart(h);
  image::EdgeMap edges = image::detect_edges(image, image::Canny{});
  const int hole = 13;
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i)
      if (std::hypot(i - 31.5, j - 31.5) < 9.5) edges.edges(i, j, hole) = 0;
  const Labels labels = label_borders(image, edges, {});
  bool any = false;
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) any |= (labels.borders(i, j, hole) & Labels::endo_bit) != 0;
  EXPECT_FALSE(any);
  const auto note = std::find_if(labels.notes.begin(), labels.notes.end(),
                                 [](const Note& n) { return n.code == "labels.endo_missing"; });
  ASSERT_NE(note, labels.notes.end());
  EXPECT_EQ(note->slice, hole);
}

TEST(Labels, SayThatNothingWasFound) {
  for (const float value : {0.0F, 1.0F})
    for (const Index3& d : {Index3{64, 64, 23}, Index3{64, 64, 1}, Index3{1, 1, 1}, Index3{3, 2, 4}}) {
      Grid g;
      g.dims = d;
      const Labels labels = labels_of(Image(g, value));
      EXPECT_FALSE(labels.has(Border::endo) || labels.has(Border::epi));
      for (const char* code : {"components.empty", "circle.no_circular_edge", "circle.no_wide_edge",
                               "slice_refine.not_in_table", "boxes.no_big_slice", "labels.no_endo", "labels.no_epi"})
        EXPECT_TRUE(has_code(labels.notes, code)) << code;
    }
}

TEST(Labels, TakeOneSliceOfAHeart) {
  HeartShape h;
  const Image all = test::blurred_heart(h);
  Grid g = all.grid;
  g.dims[2] = 1;
  Image one(g);
  std::copy_n(all.values.begin() + static_cast<std::ptrdiff_t>(all.grid.index(0, 0, 13)), g.size(), one.values.begin());
  const Labels labels = labels_of(one);
  EXPECT_TRUE(labels.has(Border::epi));
}

TEST(Labels, RefuseOptionsAndEdgesThatDoNotFit) {
  Grid g;
  g.dims = {8, 8, 2};
  const Image image(g);
  const image::EdgeMap edges = image::detect_edges(image, image::Canny{});
  Labelling o;
  o.division.jump = 2;
  EXPECT_THROW(label_borders(image, edges, o), OptionError);
  g.dims = {8, 9, 2};
  EXPECT_THROW(label_borders(Image(g), edges, {}), InputError);
}

TEST(BorderVolume, HoldsTheVoxelsOfOneBorder) {
  Labels labels;
  labels.borders.grid.dims = {4, 1, 1};
  labels.borders.values = {0, 1, 2, 3};
  EXPECT_EQ(border_volume(labels, Border::endo).values, (std::vector<float>{0, 1, 0, 1}));
  EXPECT_EQ(border_volume(labels, Border::epi).values, (std::vector<float>{0, 0, 1, 1}));
}

TEST(DivisionSlice, FollowsTheShapeOfTheHeartWhereTheApexIsNotSeen) {
  HeartShape h;
  h.defect_deg = 360, h.defect_to_slice = 8;  // no wall below: the true cavity ends in slice 5
  const Image image = test::blurred_heart(h);
  Labelling o;
  EXPECT_GT(labels_of(image, o).division_slice, 6) << "what is seen ends where the defect begins";
  o.division.expected_slice = 5.6;
  const Labels led = labels_of(image, o);
  EXPECT_EQ(led.division_slice, 5);
  EXPECT_TRUE(has_code(led.notes, "slice_find.by_shape"));
}

TEST(DivisionSlice, StaysWithAWallThatIsSeenNearTheShape) {
  const Image image = test::blurred_heart({});
  const Labels alone = labels_of(image);
  Labelling o;
  o.division.expected_slice = alone.division_slice + 1.5;  // 5.74 mm apart: within what the shape errs by
  const Labels led = labels_of(image, o);
  EXPECT_EQ(led.division_slice, alone.division_slice);
  EXPECT_FALSE(has_code(led.notes, "slice_find.by_shape"));
}

/// The cavity bright and no wall around it: the outer border of this body is the inner border of the heart.
HeartShape blood_pool() {
  HeartShape h;
  h.epi_radius_mm = h.wall_mm = 26, h.apex_wall_mm = 1e3;
  h.noise = 0.03;
  return h;
}

TEST(BloodPool, ShowsTheInnerBorderAndNoOuterOne) {
  const HeartShape h = blood_pool();
  const Image image = test::blurred_heart(h);
  const Labels labels = labels_of(image);
  EXPECT_EQ(labels.bright, ImageContrast::cavity);
  EXPECT_FALSE(labels.has(Border::epi));
  EXPECT_TRUE(has_code(labels.notes, "labels.blood_pool"));
  EXPECT_FALSE(has_code(labels.notes, "labels.no_epi"));
  EXPECT_EQ(labels.division_slice, 4) << "the cavity ends in its middle";
  double error = 0;
  int voxels = 0;
  for (int k = 7; k < h.base_slice; ++k)  // below, the tip is narrower than the blur
    for (int j = 0; j < h.dims[1]; ++j)
      for (int i = 0; i < h.dims[0]; ++i)
        if (labels.borders(i, j, k) != 0) {
          EXPECT_EQ(labels.borders(i, j, k), Labels::endo_bit);
          error += std::abs(std::hypot(i - h.x_px, j - h.y_px) - test::true_radius_px(h, k, true)), ++voxels;
        }
  ASSERT_GT(voxels, 300);
  EXPECT_LT(error / voxels, 1) << "px; blur moves the steepest place of a full body by less";
}

TEST(BloodPool, IsNoPerfusedWallHoweverBlurred) {
  for (const double fwhm : {8.0, 12.0, 16.0})
    for (const double radius : {30.0, 36.0, 48.0}) {
      HeartShape h;
      h.fwhm_mm = fwhm, h.epi_radius_mm = radius, h.noise = 0.05;
      EXPECT_EQ(labels_of(test::blurred_heart(h)).bright, ImageContrast::wall) << fwhm << " mm, radius " << radius;
    }
}

TEST(BloodPool, IsWhatThePersonSaysItIs) {
  const Image image = test::blurred_heart(blood_pool());
  Labelling o;
  o.bright = ImageContrast::wall;
  EXPECT_TRUE(labels_of(image, o).has(Border::epi));
  o.bright = ImageContrast::cavity;
  const Labels told = labels_of(test::blurred_heart(HeartShape{}), o);
  EXPECT_TRUE(told.has(Border::endo));
  EXPECT_FALSE(told.has(Border::epi));
}

TEST(BloodPool, IsReadByEveryMethodThatHasALoneBorder) {
  const HeartShape h = blood_pool();
  const Image image = test::blurred_heart(h);
  for (const LabelOptions& method :
       {LabelOptions{RadialLabels{}}, LabelOptions{NoLabels{}}, LabelOptions{Mlc{.use_gradient = false}},
        LabelOptions{Mlc{.strict_thesis = true}}}) {
    Labelling o;
    o.method = method;
    const Labels labels = labels_of(image, o);
    EXPECT_TRUE(labels.has(Border::endo));
    EXPECT_FALSE(labels.has(Border::epi));
    EXPECT_EQ(labels.division_slice, 4);
  }
}

}  // namespace
}  // namespace dynasurf::ventricle
