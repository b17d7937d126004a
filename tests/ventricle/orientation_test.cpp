#include "dynasurf/ventricle/detail/orientation.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::ventricle {
namespace {

synthetic::Phantom patient_with_tilt(double tilt_deg) {
  synthetic::VirtualPatient p;
  p.gates = 1;
  p.lattice = {52, 52, 46, 4.5, 4.5, 4.5};
  p.pose.tilt_deg = tilt_deg;
  p.pose.tilt_towards_deg = -60;
  return synthetic::make_phantom(p);
}

const heart::LvShell cup_at_an_angle{{10, -20, 30}, Vec3(-0.6, 0.64, 0.48), 30, 50, 25};

TEST(ShortAxisGrid, RunsFromApexToBaseAroundTheHeartWithColumnsLevel) {
  const Grid grid = short_axis_grid(cup_at_an_angle, 3);
  EXPECT_LT((grid.direction.col(2) - cup_at_an_angle.axis).norm(), 1e-12);
  EXPECT_NEAR(grid.direction.col(0)[2], 0, 1e-12);
  EXPECT_NEAR(grid.direction.determinant(), 1, 1e-12);
  EXPECT_LT((grid.direction.transpose() * grid.direction - Mat3::Identity()).norm(), 1e-12);
  const Vec3 apex = to_grid(grid, cup_at_an_angle.apex()), base = to_grid(grid, cup_at_an_angle.base());
  EXPECT_LT(apex[2], base[2]);
  EXPECT_GT(apex[2], 20);
  EXPECT_GT((grid.dims[2] - 1) * 3 - base[2], 20);
  EXPECT_NEAR(apex[0], (grid.dims[0] - 1) * 1.5, 1e-9) << "the axis runs through the middle of the slices";
}

TEST(Reorient, KeepsEveryPlaceInTheWorld) {
  // A linear image is exact under cubic interpolation: the new stack must hold the same function of the world.
  Study study;
  Grid grid;
  grid.dims = {60, 60, 60};
  grid.spacing = {4, 4, 4};
  grid.origin = {-100, -140, -90};
  Image image(grid);
  const auto value = [](const Vec3& w) { return static_cast<float>(1000 + w[0] + 2 * w[1] - 3 * w[2]); };
  for (int k = 0; k < 60; ++k)
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 60; ++i) image(i, j, k) = value(to_world(grid, centre_of(grid, {i, j, k})));
  study.gates = {image};
  study.view = View::transaxial;
  const Study result = reorient(study, cup_at_an_angle, 3);
  EXPECT_EQ(result.view, View::short_axis);
  EXPECT_EQ(result.slice_order, SliceOrder::apex_to_base);
  const Grid& to = result.grid();
  const Index3 centre{to.dims[0] / 2, to.dims[1] / 2, to.dims[2] / 2};
  for (const Index3& v : {centre, Index3{5, centre[1], centre[2]}, Index3{centre[0], 9, centre[2] + 4}})
    EXPECT_NEAR(result.gates[0](v[0], v[1], v[2]), value(to_world(to, centre_of(to, v))), 1e-2);
}

TEST(Orient, KeepsAShortAxisStackAndCutsOthersAnew) {
  synthetic::Phantom straight = patient_with_tilt(5);
  const auto heart = heart::locate(heart::mean_image(straight.study.gates));
  ASSERT_TRUE(heart);
  const Study kept = orient(straight.study, heart, {});
  EXPECT_EQ(kept.grid(), straight.study.grid());

  straight.study.view = View::transaxial;
  const Study cut = orient(straight.study, heart, {});
  EXPECT_EQ(cut.view, View::short_axis);
  ASSERT_FALSE(cut.notes.empty());
  EXPECT_EQ(cut.notes.back().code, "orientation.reoriented");
  EXPECT_EQ(cut.notes.back().severity, Severity::info);
}

TEST(Orient, ContradictsAHeaderOnlyWhenTheWallIsClear) {
  const synthetic::Phantom leaning = patient_with_tilt(60);
  auto heart = heart::locate(heart::mean_image(leaning.study.gates));
  ASSERT_TRUE(heart);
  const Study cut = orient(leaning.study, heart, {});
  EXPECT_FALSE(cut.grid() == leaning.study.grid());
  EXPECT_EQ(cut.notes.back().severity, Severity::warning) << "the header was wrong, so one must look";

  heart->contrast = 0.1;
  const Study kept = orient(leaning.study, heart, {});
  EXPECT_EQ(kept.grid(), leaning.study.grid());
  EXPECT_EQ(kept.notes.back().code, "orientation.uncertain");
}

TEST(Orient, TellsApexFromBaseWhereTheFileDoesNot) {
  synthetic::Phantom upside_down = patient_with_tilt(180);
  upside_down.study.slice_order = SliceOrder::unknown;
  const auto heart = heart::locate(heart::mean_image(upside_down.study.gates));
  EXPECT_EQ(orient(upside_down.study, heart, {}).slice_order, SliceOrder::base_to_apex);
}

/// A beating wall without an apex, of which nobody says which end is which: both move towards the apex and back while
/// the wall brightens, one by 12 mm, the other by 4 mm.
Study apexless(bool is_base_up) {
  Study study;
  constexpr int gates = 8;
  for (int g = 0; g < gates; ++g) {
    Grid grid;
    grid.dims = {48, 48, 40};
    grid.spacing = {4, 4, 4};
    Image image(grid);
    const Vec3 centre(94, 94, 80);
    const double systole = (1 - std::cos(2 * std::numbers::pi * g / gates)) / 2;
    const auto below = [](double height) { return 0.5 * std::erfc(height / (5 * std::numbers::sqrt2)); };
    for (int k = 0; k < 40; ++k)
      for (int j = 0; j < 48; ++j)
        for (int i = 0; i < 48; ++i) {
          Vec3 d = centre_of(grid, {i, j, k}) - centre;
          if (!is_base_up) d[2] = -d[2];
          const double level = std::sqrt((d[0] * d[0] + d[1] * d[1]) / (30.0 * 30) + d[2] * d[2] / (52.0 * 52));
          const double away = (level - 1) * 30;
          const double wall = std::exp(-away * away / (2 * 6.0 * 6.0)) * below(d[2] - 28 + 12 * systole) *
                              below(-22 - d[2] - 4 * systole);
          image(i, j, k) = (0.1 + 0.9 * wall) * (1 + 0.3 * systole);
        }
    study.gates.push_back(std::move(image));
  }
  return study;
}

TEST(LocateUpright, FollowsTheMotionOfAWallWithoutAnApex) {
  for (const bool is_base_up : {true, false}) {
    const Study study = apexless(is_base_up);
    const auto found = locate_upright(study, {});
    ASSERT_TRUE(found);
    EXPECT_GT((is_base_up ? 1 : -1) * found->cup.axis[2], 0.9);
    EXPECT_TRUE(found->is_believed());
    ASSERT_TRUE(found->outward_mm);
    Notes notes;
    note_ends(study, *found, notes);
    EXPECT_EQ(notes.size(), found->is_turned ? 1U : 0U);
  }
}

TEST(LocateUpright, FollowsTheFileWhereNothingMoves) {
  for (const SliceOrder order : {SliceOrder::apex_to_base, SliceOrder::base_to_apex}) {
    Study study = apexless(true);
    study.gates.assign(8, heart::mean_image(study.gates));
    study.slice_order = order;
    const auto found = locate_upright(study, {});
    ASSERT_TRUE(found);
    EXPECT_GT((order == SliceOrder::apex_to_base ? 1 : -1) * found->cup.axis[2], 0.9);
    study.slice_order = SliceOrder::unknown;
    Notes notes;
    note_ends(study, *found, notes);
    ASSERT_EQ(notes.size(), 1U);
  }
}

TEST(FinerPixels, KeepPlacesAndSlicesAndCoverTheHeart) {
  const synthetic::Phantom phantom = patient_with_tilt(0);
  const auto heart = heart::locate(heart::mean_image(phantom.study.gates));
  ASSERT_TRUE(heart);
  const Study fine = with_finer_pixels(phantom.study, heart->cup, 3);
  EXPECT_NEAR(fine.grid().spacing[0], 2.25, 1e-12);
  EXPECT_EQ(fine.grid().spacing[2], phantom.study.grid().spacing[2]);
  EXPECT_EQ(fine.grid().dims[2], phantom.study.grid().dims[2]);
  // The same function of the world, but for what interpolation adds.
  const Vec3 place = heart->cup.centre + 25 * fine.grid().direction.col(0);
  EXPECT_NEAR(image::sample_linear(fine.gates[0], to_grid(fine.grid(), place)),
              image::sample_cubic(phantom.study.gates[0], to_grid(phantom.study.grid(), place)), 40);
  for (const Vec3& p : {heart->cup.apex(), heart->cup.base()}) {
    const Vec3 at = to_grid(fine.grid(), p);
    for (int a = 0; a < 2; ++a) {
      EXPECT_GT(at[a], heart->cup.radius_mm);
      EXPECT_LT(at[a] + heart->cup.radius_mm, fine.grid().dims[static_cast<std::size_t>(a)] * 2.25);
    }
  }
  EXPECT_EQ(with_finer_pixels(phantom.study, heart->cup, 5).grid(), phantom.study.grid()) << "fine enough";
}

TEST(FinerPixels, KeepPixelsThatAreSquareAndWideByRoundingAlone) {
  synthetic::Phantom phantom = patient_with_tilt(0);
  const auto heart = heart::locate(heart::mean_image(phantom.study.gates));
  ASSERT_TRUE(heart);
  for (Image& image : phantom.study.gates) image.grid.spacing[1] *= 1 + 1e-15;
  const Grid& grid = phantom.study.grid();
  EXPECT_EQ(with_finer_pixels(phantom.study, heart->cup, grid.spacing[0]).grid(), grid);
  const Vec3 fine = with_finer_pixels(phantom.study, heart->cup, 0.99 * grid.spacing[0]).grid().spacing;
  for (Image& image : phantom.study.gates) image.grid.spacing[0] *= 0.98;
  const Vec3 oblong = with_finer_pixels(phantom.study, heart->cup, 0.99 * grid.spacing[1]).grid().spacing;
  EXPECT_NEAR(fine[0], fine[1], 1e-12);
  EXPECT_NEAR(oblong[0], 0.98 * oblong[1], 1e-12) << "rows and columns are divided alike";
}

TEST(Orient, RefusesWhatItMayNotOrCannotCut) {
  synthetic::Phantom phantom = patient_with_tilt(0);
  phantom.study.view = View::vertical_long_axis;
  EXPECT_THROW(orient(phantom.study, std::nullopt, {}), InputError);
  EXPECT_THROW(orient(phantom.study, heart::locate(heart::mean_image(phantom.study.gates)),
                      {.method = OrientationMethod::header, .voxel_mm = {}}),
               InputError);
}

TEST(Hints, NeedAnAxisWithALength) {
  UserOverrides manual;
  EXPECT_FALSE(hints_of(manual).axis);
  manual.axis = {0, 0, 0};
  EXPECT_THROW(hints_of(manual), OptionError) << "no length";
  manual.axis = {0, 0, 2};
  EXPECT_EQ(*hints_of(manual).axis, Vec3(0, 0, 2));
}

}  // namespace
}  // namespace dynasurf::ventricle
