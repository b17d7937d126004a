#include "dynasurf/show/detail/sheets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/show/detail/palette.hpp"

#include "pixels.hpp"

namespace dynasurf::show {
namespace {

// Sheets of 48 x 48 voxels and 6 slices: 4 points a voxel. A sheet begins 24 points from the left; below the title and
// the legend each slice has a strip of 14 points for its number. Six slices stand in four columns.
constexpr int side = 48, slices = 6, points = 4;
constexpr double left = 24, step_x = side * points + 8, step_y = side * points + 14 + 8;
constexpr io::Colour white{255, 255, 255}, yellow{240, 228, 66}, coarse_grey{150, 150, 150};

Grid stack() {
  Grid g;
  g.dims = {side, side, slices};
  return g;
}

/// Rings of edges about (24, 22): radius 8 inner border, 16 outer border, both one voxel thick, in slices 1 to 4.
struct Rings {
  ventricle::GateBorders gate;
  Image image{stack(), 0.f};
  ventricle::Circle coarse{24, 22, 21};

  Rings() {
    gate.edges.edges = Mask(stack());
    gate.labels.borders = Mask(stack());
    gate.labels.axis = {24, 22, 0, 0};
    gate.labels.circle = {24, 22, 19};
    gate.labels.local.resize(slices);
    gate.labels.local[2] = ventricle::Circle{27, 22, 8};
    gate.labels.division_slice = 3;
    image(5, 7, 1) = 1;
    for (int k = 1; k < 5; ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
          const double r = std::hypot(i - 24, j - 22);
          const bool inner = std::abs(r - 8) < 0.5, outer = std::abs(r - 16) < 0.5;
          if (!inner && !outer) continue;
          gate.edges.edges(i, j, k) = 2;
          gate.labels.borders(i, j, k) = inner ? ventricle::Labels::endo_bit : ventricle::Labels::epi_bit;
        }
    gate.edges.edges(40, 40, 2) = 1;  // a minor edge that is no border
    gate.edges.edges(44, 40, 2) = 2;  // and a major one
  }
};

/// Slices stand below the head, whose height depends on the legend: the lowest row of tiles ends 24 above the bottom.
struct Places {
  double top;
  explicit Places(const Canvas& sheet) : top(sheet.height() - 24 + 8 - 2 * step_y) {}
  Panel of(int k) const { return {left + k % 4 * step_x, top + k / 4 * step_y + 14, side * points, side * points}; }
  /// The middle of a voxel.
  Vec2 at(int k, double i, double j) const { return {of(k).x + (i + 0.5) * points, of(k).y + (j + 0.5) * points}; }
};

io::Colour colour_at(const io::Picture& picture, const Vec2& at) {
  return picture(static_cast<int>(at[0]), static_cast<int>(at[1]));
}

TEST(Sheets, EdgesLieOnTheirVoxels) {
  const Rings rings;
  const Canvas sheet = draw_edges(rings.image, rings.gate.edges, "edges");
  const io::Picture picture = sheet.pixels();
  const Places places(sheet);
  int wrong = 0, edges = 0;
  for (int k = 0; k < slices; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const int edge = rings.gate.edges.edges(i, j, k);
        const io::Colour expected = edge == 2                  ? yellow
                                    : edge == 1                ? ink_of::warm
                                    : rings.image(i, j, k) > 0 ? grey(0.92)
                                                               : io::Colour{0, 0, 0};
        edges += edge != 0;
        wrong += !is_near(colour_at(picture, places.at(k, i, j)), expected, 2);
      }
  EXPECT_GT(edges, 500);
  EXPECT_EQ(wrong, 0) << "of " << side * side * slices << " voxels";
  // Each slice has its number above it, and the legend its words.
  for (int k = 0; k < slices; ++k) {
    const Panel box = places.of(k);
    EXPECT_GT(spot_of(picture, ink_of::text, Panel{box.x, box.y - 13, 60, 12}, 60).count, 8) << k;
  }
}

TEST(Sheets, LabelsShowBordersBoxesAndCircles) {
  const Rings rings;
  const Canvas sheet = draw_labels(rings.image, rings.gate, rings.coarse, "labels");
  const io::Picture picture = sheet.pixels();
  const Places places(sheet);
  const int k = 1;
  const Panel box = places.of(k);
  const Vec2 middle = places.at(k, 24, 22);
  // The boxes of the rings, half a voxel around their pixels: 17 and 33 voxels wide.
  const Spot outer = spot_of(picture, ink_of::epi, box, 40), inner = spot_of(picture, ink_of::light, box, 40);
  EXPECT_NEAR(outer.width(), 33 * points, 2);
  EXPECT_NEAR(outer.height(), 33 * points, 2);
  EXPECT_NEAR(inner.width(), 17 * points, 2);
  EXPECT_NEAR(inner.x, middle[0], 1);
  EXPECT_NEAR(inner.y, middle[1], 1);
  EXPECT_NEAR(outer.y, middle[1], 1);
  // Its corners belong to the box alone.
  for (const double x : {-16.5, 16.5})
    for (const double y : {-16.5, 16.5}) {
      const Vec2 corner = middle + points * Vec2(x, y);
      EXPECT_GT(spot_of(picture, ink_of::epi, Panel{corner[0] - 2, corner[1] - 2, 4, 4}, 90).count, 0) << x << " " << y;
    }
  // The circles: every direction has a pixel of their colour at their radius, and none two voxels beside it.
  for (const auto& [radius, colour] : {std::pair{19.0, white}, {21.0, coarse_grey}})
    for (int n = 0; n < 24; ++n) {
      const double a = 2 * std::numbers::pi * n / 24;
      const Vec2 on = middle + points * radius * Vec2(std::cos(a), std::sin(a));
      EXPECT_GT(spot_of(picture, colour, Panel{on[0] - 2, on[1] - 2, 4, 4}, 100).count, 0) << radius << " at " << n;
    }
  EXPECT_EQ(spot_of(picture, white, Panel{middle[0] - 2, middle[1] - 11 * points, 4, 4}, 60).count, 0);
  // The cross on the axis is white, two voxels long; that of the slice's own centre green, three voxels beside it.
  EXPECT_GT(spot_of(picture, white, Panel{middle[0] + 2, middle[1] - 1, 2, 2}, 80).count, 0);
  const Vec2 own = places.at(2, 27, 22);
  EXPECT_GT(spot_of(picture, ink_of::good, Panel{own[0] - 1, own[1] + 2, 2, 2}, 60).count, 0);
  // What is no border keeps the colour of its edge.
  EXPECT_EQ(colour_at(picture, places.at(2, 40, 40)), ink_of::warm);
  EXPECT_EQ(colour_at(picture, places.at(2, 44, 40)), yellow);
}

TEST(Sheets, TheDivisionSliceAloneHasAFrame) {
  const Rings rings;
  const Canvas sheet = draw_labels(rings.image, rings.gate, rings.coarse, "labels");
  const io::Picture picture = sheet.pixels();
  const Places places(sheet);
  for (int k = 0; k < slices; ++k) {
    const Panel box = places.of(k);
    const int framed = spot_of(picture, white, Panel{box.x, box.y, 3, box.height}, 10).count;
    if (k == rings.gate.labels.division_slice)
      EXPECT_GT(framed, 2 * box.height) << k;
    else
      EXPECT_LT(framed, 40) << k;
  }
}

TEST(Sheets, RingsHaveTheirPeaksAndBars) {
  const Rings rings;
  const Canvas sheet = draw_rings(rings.image, rings.gate, {}, "rings");
  const io::Picture picture = sheet.pixels();
  // Beside each slice are 96 points for its graphs; the columns follow from the width.
  const double wide = side * points + 96 + 8, high = step_y;
  const int columns = static_cast<int>(std::lround((sheet.width() - 2 * 24 + 8) / wide));
  const int rows = (slices + columns - 1) / columns;
  const int k = 1;
  const double x = 24 + k % columns * wide, y = sheet.height() - 24 + 8 - rows * high + k / columns * high + 14;
  const Vec2 middle(x + 24.5 * points, y + 22.5 * points);
  // The peaks lie at the mean distance of the rings' pixels, 8 and 16 px: red circles there in every direction.
  for (const double radius : {8.0, 16.0}) {
    int met = 0;
    for (int n = 0; n < 24; ++n) {
      const double a = 2 * std::numbers::pi * (n + 0.5) / 24;
      const Vec2 on = middle + points * radius * Vec2(std::cos(a), std::sin(a));
      met += spot_of(picture, ink_of::epi, Panel{on[0] - 3, on[1] - 3, 6, 6}, 60).count > 0;
    }
    EXPECT_EQ(met, 24) << radius;
  }
  // Bars of the first graph, 84 points for 19 px: at 8 and at 16, the one at 16 twice as high.
  const Panel graph{x + side * points + 5, y + 2 + 9, 84, side * points / 3.0 - 4 - 9};
  const auto bar_at = [&](double radius) {
    return spot_of(picture, ink_of::epi, Panel{graph.x + (radius + 0.2) / 19 * 84, graph.y, 2, graph.height}, 60)
        .height();
  };
  const double low = std::max(bar_at(7), bar_at(8)), tall = std::max(bar_at(15), bar_at(16));
  EXPECT_GT(tall, 0.6 * graph.height);
  EXPECT_NEAR(low / tall, 0.5, 0.25);
  EXPECT_EQ(spot_of(picture, ink_of::epi, Panel{graph.x + 11.5 / 19 * 84, graph.y, 4, graph.height}, 60).count, 0);
}

TEST(Sheets, SectionsOfABallAreCircles) {
  Grid g;
  g.dims = {60, 60, 20};
  Image image(g, 0.f);
  image(30, 30, 10) = 1;
  TriMesh ball = mesh::icosphere(4);
  for (Vec3& p : ball.vertices) p = Vec3(30, 28, 10) + 9 * p;
  const Canvas sheet = draw_sections(image, ball, "ball");
  const io::Picture picture = sheet.pixels();
  // 19 slices meet the ball, and windows of 27 voxels (a fifth of 18 around it) of 7 points each, in six columns.
  const double wide = 27 * 7 + 8, high = 27 * 7 + 14 + 8;
  const int columns = static_cast<int>(std::lround((sheet.width() - 2 * 24 + 8) / wide));
  const double top = sheet.height() - 24 + 8 - std::ceil(19.0 / columns) * high;
  for (const int n : {4, 9, 14}) {  // slices 5, 10 and 15: the middle and five beside it
    const Panel box{24 + n % columns * wide, top + n / columns * high + 14, 27 * 7.0, 27 * 7.0};
    const Spot ring = spot_of(picture, ink_of::epi, box, 60);
    const double radius = std::sqrt(81.0 - (n - 9) * (n - 9));
    EXPECT_NEAR(ring.width(), 2 * radius * 7, 4) << n;
    EXPECT_NEAR(ring.height(), 2 * radius * 7, 4) << n;
    EXPECT_NEAR(ring.x + 0.5, box.x + box.width / 2, 2) << n;
  }
}

TEST(Sheets, AMatrixHasACellForEveryChoice) {
  const Rings rings;
  std::vector<std::vector<MatrixCell>> rows(2);
  for (std::size_t r = 0; r < 2; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      MatrixCell cell{"choice", {}};
      cell.borders.study.gates = {rings.image};
      cell.borders.coarse = rings.coarse;
      cell.borders.gates = {rings.gate};
      cell.borders.gates[0].edges.edges = Mask(stack());
      // Each cell has one edge of its own.
      cell.borders.gates[0].edges.edges(20 + static_cast<int>(c), 20 + static_cast<int>(r), 2) = 2;
      rows[r].push_back(std::move(cell));
    }
  const Canvas sheet = draw_matrix(rows, 2, MatrixDrawing::edges, "matrix");
  const io::Picture picture = sheet.pixels();
  // A window of 2 (21 + 4) + 1 = 51 voxels about (24, 22), 3 points each.
  const double cell = 51 * 3, top = sheet.height() - 24 + 8 - 2 * (cell + 14 + 8);
  for (int r = 0; r < 2; ++r)
    for (int c = 0; c < 3; ++c) {
      const Panel box{24 + c * (cell + 8), top + r * (cell + 14 + 8) + 14, cell, cell};
      const Spot edge = spot_of(picture, yellow, box, 10);
      EXPECT_EQ(edge.count, 9) << r << " " << c;
      EXPECT_NEAR(edge.x + 0.5, box.x + (20 + c - (24 - 25) + 0.5) * 3, 0.1);
      EXPECT_NEAR(edge.y + 0.5, box.y + (20 + r - (22 - 25) + 0.5) * 3, 0.1);
    }
}

}  // namespace
}  // namespace dynasurf::show
