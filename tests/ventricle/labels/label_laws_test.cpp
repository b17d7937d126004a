// The laws of all labelling methods, and the known answers of the simpler ones. A new method comes under the laws by
// its place in LabelOptions.
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/ventricle/label_borders.hpp"
#include "dynasurf/ventricle/labels/detail/radial.hpp"
#include "dynasurf/ventricle/labels/detail/slice_flow.hpp"

#include "support/blurred_heart.hpp"
#include "support/method_types.hpp"
#include "support/notes.hpp"

namespace dynasurf::ventricle {
namespace {

using test::has_code;
using test::HeartShape;

Labels labels_of(const Image& image, Labelling o, const CoarseCircle& coarse = {}) {
  o.coarse = coarse;
  return label_borders(image, image::detect_edges(image, image::Canny{}), o);
}

Labelling with(const LabelOptions& method) {
  Labelling o;
  o.method = method;
  return o;
}

template <class Options>
class LabelLaws : public testing::Test {
 public:
  /// The method as it is, and in the settings that take another way through it or through the search of the circle.
  static std::vector<Labelling> variants() {
    std::vector<Labelling> all{with(Options{})};
    if constexpr (std::is_same_v<Options, Mlc>) {
      all.push_back(with(Mlc{.use_gradient = false}));
      all.push_back(with(Mlc{.strict_thesis = true, .box_margin_px = 0}));
    }
    if constexpr (std::is_same_v<Options, RadialLabels>)
      for (const int ring : {2, 3}) all.push_back(with(RadialLabels{.ring_px = ring}));
    Labelling as_published = all.back();
    as_published.circle.robust_fit = false;
    all.push_back(as_published);
    all.push_back(with(Options{}));
    all.back().bright = ImageContrast::cavity;
    return all;
  }
};

TYPED_TEST_SUITE(LabelLaws, test::MethodTypes<LabelOptions>::type, test::MethodName);

TYPED_TEST(LabelLaws, MoveWithTheImage) {
  HeartShape h;
  h.fwhm_mm = 8;
  const Image image = test::blurred_heart(h), moved = test::shifted(image, 3, -2);
  for (Labelling o : this->variants()) {
    o.circle.centre_width = 10;  // what is preferred near the middle of the image does not move with its contents
    const Labels at = labels_of(image, o, {.x_px = 31.5, .y_px = 31.5, .radius_px = 20}),
                 there = labels_of(moved, o, {.x_px = 34.5, .y_px = 29.5, .radius_px = 20});
    EXPECT_GT(std::count_if(at.borders.values.begin(), at.borders.values.end(), [](auto v) { return v != 0; }), 300);
    EXPECT_EQ(there.borders.values, test::shifted(at.borders, 3, -2).values);
    EXPECT_EQ(there.division_slice, at.division_slice);
  }
}

TYPED_TEST(LabelLaws, TurnWithTheImage) {
  HeartShape h;
  h.noise = 0.03, h.defect_deg = 70;
  const Image image = test::blurred_heart(h), turned = test::quarter_turn(image);
  for (const Labelling& o : this->variants())
    EXPECT_EQ(labels_of(turned, o).borders.values, test::quarter_turn(labels_of(image, o).borders).values);
}

TYPED_TEST(LabelLaws, IgnoreTheContrastThatNormalisingTakesAway) {
  HeartShape h;
  h.noise = 0.03;
  const Image image = test::blurred_heart(h);
  Image counts = image;
  for (float& v : counts.values) v *= 713;
  Notes notes;
  counts = image::normalise(std::move(counts), notes);
  for (const Labelling& o : this->variants())
    EXPECT_EQ(labels_of(counts, o).borders.values, labels_of(image, o).borders.values);
}

TYPED_TEST(LabelLaws, AreTheSameForAnyNumberOfThreads) {
  HeartShape h;
  h.noise = 0.05;
  const Image image = test::blurred_heart(h);
  for (const Labelling& o : this->variants()) {
    std::vector<std::uint8_t> reference;
    for (const int threads : {1, 2, 4}) {
      const ThreadLimit limit(threads);
      const Labels labels = labels_of(image, o);
      if (threads == 1) reference = labels.borders.values;
      EXPECT_EQ(labels.borders.values, reference) << threads;
    }
  }
}

TYPED_TEST(LabelLaws, SayThatNothingWasFound) {
  for (const Index3& d : {Index3{64, 64, 5}, Index3{64, 64, 1}, Index3{1, 1, 1}, Index3{3, 2, 4}}) {
    Grid g;
    g.dims = d;
    for (const Labelling& o : this->variants()) {
      const Labels labels = labels_of(Image(g, 0.5F), o);
      EXPECT_FALSE(labels.has(Border::endo) || labels.has(Border::epi));
      EXPECT_TRUE(has_code(labels.notes, "labels.no_endo"));
      EXPECT_EQ(has_code(labels.notes, "labels.no_epi"), o.bright != ImageContrast::cavity) << "a blood pool has none";
    }
  }
}

/// Share of the labelled pixels of a wall, in the slices through the cavity, that lie nearer to the other border; and
/// the mean distance of the pixels from the nearer one.
struct Agreement {
  double wrong = 0, error_px = 0;
  int pixels = 0;
};

Agreement agreement(const Labels& labels, const HeartShape& h, Border wall, int from, int to) {
  Agreement a;
  const std::uint8_t bit = wall == Border::endo ? Labels::endo_bit : Labels::epi_bit;
  for (int k = from; k <= to; ++k)
    for (int j = 0; j < h.dims[1]; ++j)
      for (int i = 0; i < h.dims[0]; ++i) {
        if (!(labels.borders(i, j, k) & bit)) continue;
        const double d = std::hypot(i - test::centre_x(h, k), j - test::centre_y(h, k));
        const double own = std::abs(d - test::true_radius_px(h, k, wall == Border::epi)),
                     other = std::abs(d - test::true_radius_px(h, k, wall != Border::epi));
        a.wrong += other < own, a.error_px += std::min(own, other), a.pixels += 1;
      }
  a.wrong /= std::max(1, a.pixels), a.error_px /= std::max(1, a.pixels);
  return a;
}

HeartShape sharp_heart() {
  HeartShape h;
  h.fwhm_mm = 5, h.epi_radius_mm = 42, h.wall_mm = 14;
  return h;
}

TEST(SignLabels, MarkBothBordersAndNotTheMiddleOfTheWall) {
  const HeartShape h = sharp_heart();
  const Labels labels = labels_of(test::blurred_heart(h), with(SignLabels{}));
  EXPECT_TRUE(has_code(labels.notes, "labels.not_told_apart"));
  const Agreement a = agreement(labels, h, Border::epi, 11, 15);
  EXPECT_GT(a.pixels, 5 * 60);
  EXPECT_LT(a.error_px, 1);
  int in_middle = 0;
  for (int k = 11; k <= 15; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 64; ++i) {
        const double middle = (test::true_radius_px(h, k, true) + test::true_radius_px(h, k, false)) / 2;
        in_middle += labels.borders(i, j, k) && std::abs(std::hypot(i - 31.5, j - 31.5) - middle) < 0.7;
      }
  EXPECT_LT(in_middle, 0.02 * a.pixels);
}

TEST(GradMagLabels, MarkWhereTheFieldIsQuiet) {
  const HeartShape h = sharp_heart();
  const Labels labels = labels_of(test::blurred_heart(h), with(GradMagLabels{}));
  const Agreement a = agreement(labels, h, Border::epi, 11, 15);
  EXPECT_GT(a.pixels, 5 * 40);
  EXPECT_LT(a.error_px, 1.3);  // some points in the middle of the wall are quiet too
}

TEST(CaseLabels, AreRightOnAFullPhantomAndWrongOnASickOne) {
  HeartShape h = sharp_heart();
  h.fwhm_mm = 12;
  const Labels full = labels_of(test::blurred_heart(h), with(CaseLabels{}));
  for (const Border wall : {Border::endo, Border::epi}) {
    EXPECT_GT(agreement(full, h, wall, 11, 15).pixels, 5 * 30) << name_of(wall);
    EXPECT_EQ(agreement(full, h, wall, 11, 15).wrong, 0) << name_of(wall);
  }
  HeartShape sick = h;
  sick.defect_deg = 120;
  const Labels open = labels_of(test::blurred_heart(sick), with(CaseLabels{})),
               mlc = labels_of(test::blurred_heart(sick), with(Mlc{}));
  EXPECT_GT(agreement(open, sick, Border::epi, 11, 15).wrong, 0.05);
  EXPECT_LT(agreement(mlc, sick, Border::epi, 11, 15).wrong, 0.02);
  EXPECT_TRUE(has_code(open.notes, "case.unknown"));
}

std::vector<image::Component> circles(const std::vector<double>& radii, double x = 31.5) {
  image::Component c{0, {}};
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i)
      for (const double r : radii)
        if (std::abs(std::hypot(i - x, j - 31.5) - r) <= 0.5) c.pixels.push_back({i, j});
  return {c};
}

TEST(RadialLabels, SeeAPeakPerCircle) {
  const RadialProfile p = radial_profile(circles({7.5, 12.5}), {31.5, 31.5, 0, 0}, 30, {});
  ASSERT_EQ(p.peaks_px.size(), 2U);
  EXPECT_NEAR(p.peaks_px[0], 7.5, 0.3);
  EXPECT_NEAR(p.peaks_px[1], 12.5, 0.3);
}

TEST(RadialLabels, FlattenWhenTheCentreIsWrong) {
  const auto highest = [](const RadialProfile& p) { return *std::max_element(p.counts.begin(), p.counts.end()); };
  const RadialProfile at = radial_profile(circles({7.5, 12.5}), {31.5, 31.5, 0, 0}, 30, {}),
                      off = radial_profile(circles({7.5, 12.5}), {34.5, 31.5, 0, 0}, 30, {});
  EXPECT_LT(highest(off), 0.6 * highest(at));
}

TEST(RadialLabels, LeaveOutWhatLiesBeyondTheCircle) {
  const RadialProfile p = radial_profile(circles({7.5, 12.5, 25.5}), {31.5, 31.5, 0, 0}, 16, {});
  EXPECT_THAT(p.peaks_px, testing::ElementsAre(testing::DoubleNear(7.5, 0.3), testing::DoubleNear(12.5, 0.3)));
}

TEST(RadialLabels, AreRightOnARoundHeart) {
  const HeartShape h = sharp_heart();
  const Labels labels = labels_of(test::blurred_heart(h), with(RadialLabels{}));
  for (const Border wall : {Border::endo, Border::epi}) {
    const Agreement a = agreement(labels, h, wall, 11, 15);
    EXPECT_GT(a.pixels, 5 * 30);
    EXPECT_LT(a.wrong, 0.02) << name_of(wall);
  }
  EXPECT_NEAR(labels.division_slice, 6, 3);
}

TEST(NoLabels, KeepEveryEdgeForEitherWall) {
  const HeartShape h = sharp_heart();
  const Labels labels = labels_of(test::blurred_heart(h), with(NoLabels{}));
  EXPECT_EQ(border_volume(labels, Border::endo).values, border_volume(labels, Border::epi).values);
  EXPECT_TRUE(labels.has(Border::endo));
  EXPECT_TRUE(has_code(labels.notes, "labels.not_told_apart"));
}

/// Share of the pixels of the cavity whose flow, straight from the intensities, leads outwards to the wall.
double share_led_outwards(const HeartShape& h) {
  const Image image = test::blurred_heart(h);
  Grid one = image.grid;
  one.dims[2] = 1;
  double right = 0, all = 0;
  for (int k = 10; k <= 15; ++k) {
    Image slice(one);
    std::copy_n(image.values.begin() + static_cast<std::ptrdiff_t>(image.grid.index(0, 0, k)), one.size(),
                slice.values.begin());
    const field::VectorField f = field::flow_field(slice, field::Gvf{.mu = 0.2, .iterations = 100}).field;
    for (int j = 0; j < one.dims[1]; ++j)
      for (int i = 0; i < one.dims[0]; ++i) {
        const double dx = i - test::centre_x(h, k), dy = j - test::centre_y(h, k), d = std::hypot(dx, dy);
        if (d > test::true_radius_px(h, k, false) || d < 0.5) continue;
        const std::size_t n = one.index(i, j, 0);
        right += f.x[n] * dx + f.y[n] * dy > 0.5 * d * std::hypot(f.x[n], f.y[n]), all += 1;
      }
  }
  return right / all;
}

TEST(NoLabels, LeadOutwardsOnlyInLargeCavities) {
  HeartShape large, small;
  large.noise = small.noise = 0.06;
  small.epi_radius_mm = 17, small.wall_mm = 10, small.apex_wall_mm = 10;  // a region of 12 x 12 pixels
  EXPECT_GT(share_led_outwards(large), 0.9);
  EXPECT_LT(share_led_outwards(small), 0.8 * share_led_outwards(large));
}

}  // namespace
}  // namespace dynasurf::ventricle
