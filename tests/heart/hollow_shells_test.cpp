#include "dynasurf/heart/detail/hollow_shells.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dynasurf::heart {
namespace {

Image cubic_image(const Index3& dims, double spacing) {
  Grid grid;
  grid.dims = dims;
  grid.spacing = Vec3::Constant(spacing);
  return Image(grid);
}

/// Contrast of a shell as it is defined, one voxel at a time.
double worth_by_definition(const Image& image, double radius, const Index3& middle) {
  const auto value = [&](const Vec3& direction, double mm) {
    const auto steps = [&](int a) { return static_cast<int>(std::lround(mm * direction[a] / image.grid.spacing[a])); };
    return static_cast<double>(image.clamped(middle[0] + steps(0), middle[1] + steps(1), middle[2] + steps(2)));
  };
  std::vector<double> contrast;
  for (const Vec3& d : cube_directions()) {
    const double inside = value(d, radius - 14), outside = value(d, radius + 14);
    contrast.push_back(value(d, radius) - 0.75 * std::max(inside, outside) - 0.25 * std::min(inside, outside));
  }
  std::sort(contrast.begin(), contrast.end());
  double sum = 0;
  for (std::size_t n = 9; n < 22; ++n) sum += contrast[n];
  return sum / 13;
}

TEST(HollowShells, TheMiddleOfAShellIsTheBestPlace) {
  Image image = cubic_image({30, 26, 22}, 7);
  const Vec3 middle(105, 91, 70);
  for (int k = 0; k < 22; ++k)
    for (int j = 0; j < 26; ++j)
      for (int i = 0; i < 30; ++i) {
        const double away = ((centre_of(image.grid, {i, j, k}) - middle).norm() - 28) / 8;
        image(i, j, k) = static_cast<float>(std::exp(-away * away));
      }
  const std::vector<Place> places = find_places(image);
  ASSERT_FALSE(places.empty());
  EXPECT_LE((places[0].centre - middle).norm(), 1e-9);
  EXPECT_EQ(places[0].radius_mm, 28);
}

TEST(HollowShells, WorthIsTheMeanOfTheMiddlingDirections) {
  for (const Index3& dims : {Index3{19, 7, 5}, Index3{8, 4, 3}, Index3{3, 2, 2}}) {
    Image image = cubic_image(dims, 7);
    std::mt19937 random(3);
    for (float& v : image.values) v = static_cast<float>(random() % 1000);
    const std::vector<Place> places = find_places(image);
    ASSERT_FALSE(places.empty());
    double best = 0;
    for (int k = 0; k < dims[2]; ++k)
      for (int j = 0; j < dims[1]; ++j)
        for (int i = 0; i < dims[0]; ++i)
          for (const double radius : shell_radii_mm)
            best = std::max(best, worth_by_definition(image, radius, {i, j, k}));
    EXPECT_EQ(places[0].worth, static_cast<float>(best));  // sums of whole numbers are exact
    for (const Place& p : places) {
      Index3 voxel;
      for (int a = 0; a < 3; ++a) voxel[a] = static_cast<int>(std::lround(p.centre[a] / 7));
      EXPECT_EQ(p.worth, static_cast<float>(worth_by_definition(image, p.radius_mm, voxel)));
    }
  }
}

TEST(HollowShells, PlacesAreApart) {
  Image image = cubic_image({24, 24, 12}, 7);
  std::mt19937 random(5);
  for (float& v : image.values) v = static_cast<float>(random() % 1000);
  const std::vector<Place> places = find_places(image);
  ASSERT_EQ(places.size(), 10u);
  for (std::size_t a = 0; a < places.size(); ++a) {
    EXPECT_LE(places[a].worth, places[a == 0 ? 0 : a - 1].worth);
    for (std::size_t b = 0; b < a; ++b) EXPECT_GE((places[a].centre - places[b].centre).norm(), places_apart_mm);
  }
}

TEST(HollowShells, PlacesAreTheBestOnesOfEqualOnesTheFirst) {
  const Index3 dims{14, 12, 9};
  Image image = cubic_image(dims, 7);
  std::mt19937 random(7);
  for (float& v : image.values) v = static_cast<float>(13 * (random() % 3));  // many shells are worth the same
  struct Known {
    Vec3 centre;
    double radius = 0, worth = 0;
  };
  std::vector<Known> all;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        all.push_back({centre_of(image.grid, {i, j, k})});
        for (const double radius : shell_radii_mm) {
          const auto worth = static_cast<float>(worth_by_definition(image, radius, {i, j, k}));
          if (worth > all.back().worth) all.back().worth = worth, all.back().radius = radius;
        }
      }
  std::stable_sort(all.begin(), all.end(), [](const Known& a, const Known& b) { return a.worth > b.worth; });
  std::vector<Known> expected;
  for (const Known& place : all)
    if (place.worth > 0 && expected.size() < 10 && std::all_of(expected.begin(), expected.end(), [&](const Known& e) {
          return (e.centre - place.centre).norm() >= places_apart_mm;
        }))
      expected.push_back(place);
  const std::vector<Place> places = find_places(image);
  ASSERT_EQ(places.size(), expected.size());
  for (std::size_t n = 0; n < places.size(); ++n) {
    EXPECT_EQ(places[n].centre, expected[n].centre);
    EXPECT_EQ(places[n].radius_mm, expected[n].radius);
    EXPECT_EQ(places[n].worth, expected[n].worth);
  }
}

}  // namespace
}  // namespace dynasurf::heart
