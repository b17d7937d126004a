#include "dynasurf/ventricle/detail/relabel.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dynasurf::ventricle {
namespace {

constexpr int gates = 8, slices = 4, side = 48;
constexpr double pixel_mm = 2, middle_px = 23.5;

Grid slab() {
  Grid grid;
  grid.dims = {side, side, slices};
  grid.spacing = {pixel_mm, pixel_mm, 5};
  return grid;
}

/// Voxels within half a pixel of a circle get a bit.
void draw_ring(Mask& mask, double radius_px, std::uint8_t bit) {
  for (int k = 0; k < slices; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i)
        if (std::abs(std::hypot(i - middle_px, j - middle_px) - radius_px) < 0.5) mask(i, j, k) |= bit;
}

Labels rings(double endo_px, double epi_px) {
  Labels labels;
  labels.borders = Mask(slab());
  labels.circle = {middle_px, middle_px, 22};
  labels.axis = {middle_px, middle_px, 0, 0};
  draw_ring(labels.borders, endo_px, Labels::endo_bit);
  draw_ring(labels.borders, epi_px, Labels::epi_bit);
  return labels;
}

double endo_px(int gate) { return 10 + 2 * std::cos(2 * std::numbers::pi * gate / gates); }
double epi_px(int gate) { return 15 + std::cos(2 * std::numbers::pi * gate / gates); }

std::vector<Labels> beat() {
  std::vector<Labels> all;
  for (int g = 0; g < gates; ++g) all.push_back(rings(endo_px(g), epi_px(g)));
  return all;
}

std::vector<std::optional<double>> strays_of(const std::vector<Labels>& all) {
  std::vector<GateLabels> list;
  for (const Labels& labels : all) list.push_back({&labels, slices - 1});
  return strays_mm(list);
}

TEST(Strays, AreSmallInASmoothBeat) {
  for (const auto& stray : strays_of(beat())) {
    ASSERT_TRUE(stray);
    EXPECT_LT(*stray, 1) << "half a pixel: rings of voxels are not circles";
  }
  EXPECT_TRUE(gates_to_help(strays_of(beat())).empty());
}

TEST(Strays, NameTheGateThatTookAnotherBorderAndItsHelpers) {
  std::vector<Labels> all = beat();
  all[3] = rings(endo_px(3), 20);  // a hot neighbour's edge in place of the wall's
  all[2].borders = Mask(slab());
  const auto strays = strays_of(all);
  EXPECT_FALSE(strays[2]) << "no border at all";
  ASSERT_TRUE(strays[3]);
  EXPECT_NEAR(*strays[3], (20 - epi_px(3)) * pixel_mm, 2.5);
  const auto help = gates_to_help(strays);
  ASSERT_EQ(help.size(), 2U);
  EXPECT_EQ(help[0].gate, 2U);
  EXPECT_EQ(help[1].gate, 3U);
  EXPECT_EQ(help[1].before, 1U);
  EXPECT_EQ(help[1].after, 4U);
}

TEST(Strays, HelpNobodyWhenTooManyDisagree) {
  const std::vector<std::optional<double>> strays{std::nullopt, 9.0, 9.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(gates_to_help(strays).empty());
  EXPECT_TRUE(gates_to_help(std::vector<std::optional<double>>{9.0, 0.0, 0.0, 0.0}).empty()) << "too few gates";
}

TEST(Relabel, GivesEdgesToTheWallThatNeighboursHaveThere) {
  const Labels truth = rings(endo_px(3), epi_px(3));
  Mask edges(slab());
  draw_ring(edges, endo_px(3), 1);
  draw_ring(edges, epi_px(3), 1);
  draw_ring(edges, 21.5, 1);  // another structure, far from any border of the neighbours
  const Labels found = relabel(edges, rings(endo_px(2), epi_px(2)), rings(endo_px(4), epi_px(4)), 5);
  EXPECT_EQ(found.borders.values, truth.borders.values);
}

TEST(DivisionSlice, IsSharedByGatesThatCouldOnlyGuessIt) {
  std::vector<Labels> beat(8);
  const auto guess = [](Labels& gate, int slice) {
    gate.division_slice = slice;
    gate.notes.push_back({Severity::warning, "slice_find.no_rise", "", -1, slice});
  };
  for (int g = 0; g < 3; ++g) beat[static_cast<std::size_t>(g)].division_slice = 2 + g;
  for (std::size_t g = 3; g < 7; ++g) guess(beat[g], 9);
  guess(beat[7], 1);
  std::vector<Labels*> all;
  for (Labels& gate : beat) all.push_back(&gate);
  share_division_slice(all);
  const auto found_slices = [&] {
    std::vector<int> found;
    for (const Labels& gate : beat) found.push_back(gate.division_slice);
    return found;
  };
  EXPECT_EQ(found_slices(), (std::vector{2, 3, 4, 3, 3, 3, 3, 1})) << "blur hides the end of a cavity, it adds none";
  EXPECT_EQ(beat[3].notes.back().code, "slice_find.shared");
  EXPECT_EQ(beat[7].notes.back().code, "slice_find.no_rise");
}

TEST(DivisionSlice, IsNotSharedWhenFewSawIt) {
  std::vector<Labels> beat(8);
  for (Labels& gate : beat) {
    gate.division_slice = 9;
    gate.notes.push_back({Severity::warning, "slice_find.no_rise", "", -1, 9});
  }
  beat[0].notes.clear(), beat[0].division_slice = 2;
  std::vector<Labels*> all;
  for (Labels& gate : beat) all.push_back(&gate);
  share_division_slice(all);
  EXPECT_EQ(beat[5].division_slice, 9);
}

}  // namespace
}  // namespace dynasurf::ventricle
