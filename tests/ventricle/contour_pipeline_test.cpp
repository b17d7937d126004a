#include "dynasurf/ventricle/detail/contour_pipeline.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double pixel_mm = 3, slice_mm = 6;
constexpr int side = 48, slices = 12, base = 10;
const Vec2 centre_px(23.4, 24.2);

double outer_radius(int k) { return 14 - 0.08 * (k - 7) * (k - 7); }
double inner_radius(int k) { return outer_radius(k) - 5; }

/// A wall between two radii in every slice up to the base, its profile half a pixel soft.
Image wall_image() {
  Grid grid;
  grid.dims = {side, side, slices};
  grid.spacing = {pixel_mm, pixel_mm, slice_mm};
  Image image(grid);
  for (int k = 2; k <= base; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const double r = (Vec2(i, j) - centre_px).norm();
        const auto soft = [](double x) { return 0.5 * std::erfc(x); };
        image(i, j, k) = static_cast<float>(soft(r - outer_radius(k)) - soft(r - inner_radius(k)));
      }
  return image;
}

Labels labels_of(const Image& image) {
  Labels labels;
  labels.borders = Mask(image.grid);
  for (int k = 2; k <= base; ++k)
    labels.borders(static_cast<int>(centre_px.x() + inner_radius(k)), 24,
                   k) = Labels::endo_bit,
                   labels.borders(static_cast<int>(centre_px.x() + outer_radius(k)), 24, k) = Labels::epi_bit;
  labels.circle = {centre_px.x(), centre_px.y(), 17};
  labels.axis = {centre_px.x(), centre_px.y(), 0, 0};
  labels.division_slice = 2;
  return labels;
}

double mean_error(const Contour& c, double radius) {
  double sum = 0;
  for (const Vec2& p : c.points) sum += std::abs((p - centre_px).norm() - radius);
  return sum / static_cast<double>(c.size());
}

TEST(ContourPipeline, FindsBothWallsInEverySliceToHalfAPixel) {
  const Image image = wall_image();
  const Labels labels = labels_of(image);
  const WallContours epi = propagate_contours(image, labels, Border::epi, base, {});
  const WallContours endo = propagate_contours(image, labels, Border::endo, base, {}, &epi);
  EXPECT_EQ(epi.found, 9);
  EXPECT_EQ(endo.found, 8);  // none in the division slice
  EXPECT_FALSE(endo.slices[2].has_value());
  EXPECT_FALSE(epi.slices[11].has_value());
  for (int k = 2; k <= base; ++k) {
    const auto at = static_cast<std::size_t>(k);
    ASSERT_TRUE(epi.slices[at]);
    EXPECT_LT(mean_error(*epi.slices[at], outer_radius(k)), 0.5) << k;
    if (k == 2) continue;
    EXPECT_LT(mean_error(*endo.slices[at], inner_radius(k)), 0.5) << k;
  }
}

TEST(ContourPipeline, KeepsTheForcesThatBalanceAtRest) {
  const Image image = wall_image();
  const ContourPipeline options;
  const WallContours epi = propagate_contours(image, labels_of(image), Border::epi, base, options);
  double pulled = 0, left = 0;
  for (int k = 2; k <= base; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const std::vector<Vec2>& points = epi.slices[at]->points;
    ASSERT_EQ(epi.pulls[at].size(), points.size());
    ASSERT_EQ(epi.bends[at].size(), points.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
      const Vec2 out = (points[n] - centre_px).normalized();
      const double pull = options.model.external * epi.pulls[at][n].dot(out);
      EXPECT_LE(epi.pulls[at][n].norm(), 1 + 1e-9);
      pulled += std::abs(pull);
      left += std::abs(pull + options.model.internal * epi.bends[at][n].dot(out));
    }
  }
  EXPECT_GT(pulled, 0);
  EXPECT_LT(left, 0.3 * pulled);
}

TEST(ContourPipeline, SurvivesASliceThatFails) {
  Image image = wall_image();
  const std::size_t plane = side * side;
  // Slice 5 shows a small bright dot in place of the heart.
  std::fill_n(image.values.begin() + 5 * plane, plane, 0.0F);
  for (int j = 23; j <= 25; ++j)
    for (int i = 22; i <= 24; ++i) image(i, j, 5) = 1;
  ContourPipeline options;
  options.best_slice = 8;
  const WallContours epi = propagate_contours(image, labels_of(image), Border::epi, base, options);
  EXPECT_EQ(epi.best_slice, 7);
  ASSERT_TRUE(epi.slices[5] && epi.slices[4]);
  EXPECT_EQ(epi.slices[5]->points, epi.slices[6]->points);
  ASSERT_EQ(epi.notes.size(), 1U);
  EXPECT_EQ(epi.notes[0].code, "contour.jump");
  EXPECT_EQ(epi.notes[0].slice, 5);
  EXPECT_LT(mean_error(*epi.slices[4], outer_radius(4)), 0.5);
}

TEST(ContourPipeline, TellsWhereItBeginsInsteadOfASliceWithoutABorder) {
  const Image image = wall_image();
  ContourPipeline options;
  options.best_slice = 1;
  const WallContours endo = propagate_contours(image, labels_of(image), Border::endo, base, options);
  EXPECT_EQ(endo.best_slice, 3);
  ASSERT_FALSE(endo.notes.empty());
  EXPECT_EQ(endo.notes[0].code, "contour.best_slice");
  EXPECT_EQ(endo.notes[0].message, "slice 1 has no endocardial border; its contours begin in slice 4");
  options.best_slice = image.grid.dims[2] + 1;
  EXPECT_THROW((void)propagate_contours(image, labels_of(image), Border::endo, base, options), OptionError);
}

TEST(ContourPipeline, TellsWhenThereIsNothingToBeginWith) {
  Image image = wall_image();
  std::fill(image.values.begin(), image.values.end(), 0.0F);
  Labels labels = labels_of(image);
  labels.circle.radius_px = 0;
  const WallContours none = propagate_contours(image, labels, Border::epi, base, {});
  EXPECT_EQ(none.found, 0);
  ASSERT_EQ(none.notes.size(), 1U);
  EXPECT_EQ(none.notes[0].code, "contour.none");
  EXPECT_FALSE(contour_surface(none, image.grid, {}));
}

TEST(ContourSurface, IsClosedAndEnclosesItsContours) {
  const Image image = wall_image();
  const WallContours epi = propagate_contours(image, labels_of(image), Border::epi, base, {});
  for (const StackEnds ends : {StackEnds::slice_centre, StackEnds::slice_face}) {
    ContourPipeline options;
    options.ends = ends;
    const auto surface = contour_surface(epi, image.grid, options);
    ASSERT_TRUE(surface);
    const mesh::Topology t = mesh::topology(surface->evolved.mesh);
    EXPECT_TRUE(t.closed() && t.oriented());
    EXPECT_EQ(t.euler, 2);
    double truth = 0;  // trapezoids of the true areas
    const auto area = [](int k) { return std::numbers::pi * std::pow(pixel_mm * outer_radius(k), 2); };
    for (int k = 2; k < base; ++k) truth += slice_mm * (area(k) + area(k + 1)) / 2;
    if (ends == StackEnds::slice_face) truth += slice_mm / 2 * (area(base) + area(2) / 2);
    EXPECT_NEAR(surface->volumes.trapezoid, truth, 0.04 * truth);  // a fifth of a pixel in the radius
    EXPECT_NEAR(surface->volumes.gauss, surface->volumes.triangle_exact, 1e-9 * truth);
    EXPECT_DOUBLE_EQ(surface->volumes.gauss, mesh::volume_mm3(surface->evolved.mesh));
  }
}

TEST(ContourPipeline, ReconstructsACycleFromOneOption) {
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::CardiacCycle{});
  Options options = preset("edges");
  options.pipeline = Pipeline::contour;
  const Result result = reconstruct(phantom.study, options);
  ASSERT_EQ(result.gates.size(), phantom.truth.size());
  for (const Gate& gate : result.gates) {
    ASSERT_TRUE(gate.edge_surfaces.endo && gate.edge_surfaces.epi);
    ASSERT_TRUE(gate.edge_surfaces.endo->stack && gate.edge_surfaces.epi->stack);
    EXPECT_LT(gate.edge_surfaces.endo->volume_ml, gate.edge_surfaces.epi->volume_ml);
    EXPECT_NEAR(gate.edge_surfaces.epi->stack->gauss, gate.edge_surfaces.epi->stack->triangle_exact, 1);
    EXPECT_TRUE(mesh::topology(gate.edge_surfaces.endo->mesh).closed());
  }
  EXPECT_EQ(result.readings.edge.ed_gate, 7);
  EXPECT_EQ(result.readings.edge.es_gate, 3);
  EXPECT_NEAR(result.readings.edge.ef_percent->value, *phantom.ef_percent, 3);
}

}  // namespace
}  // namespace dynasurf::ventricle
