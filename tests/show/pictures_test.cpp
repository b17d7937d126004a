#include "dynasurf/show/detail/pictures.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/show/detail/palette.hpp"
#include "dynasurf/show/detail/plane.hpp"

#include "pixels.hpp"

namespace dynasurf::show {
namespace {

Grid cube_of(int side, double mm = 1) {
  Grid g;
  g.dims = {side, side, side};
  g.spacing = Vec3::Constant(mm);
  return g;
}

TriMesh ball(double radius, const Vec3& centre = Vec3::Zero()) {
  TriMesh mesh = mesh::icosphere(4);
  for (Vec3& p : mesh.vertices) p = centre + radius * p;
  return mesh;
}

/// Vectors along i towards the plane i = `at`, as long as their distance from it.
field::VectorField towards(const Grid& g, double at) {
  field::VectorField field(g);
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) field.x[g.index(i, j, k)] = static_cast<float>(at - i);
  return field;
}

TEST(Scene3d, DrawsABallAsADiscOfItsSize) {
  Scene3d scene;
  scene.add(ball(25), {255, 255, 255});
  Canvas canvas(300, 300);
  canvas.rectangle({0, 0, 300, 300}, ink_of::endo);  // the ball is what hides it
  const double mm = scene.draw(canvas, {0, 0, 300, 300}, {}, 0.25);
  EXPECT_EQ(mm, 0.25);
  const io::Picture picture = canvas.pixels();
  const double hidden = 300 * 300 - spot_of(picture, ink_of::endo, {}, 2).count;
  const double disc = std::numbers::pi * 100 * 100;  // 25 mm at a quarter of a mm to a point
  EXPECT_NEAR(hidden, disc, 0.03 * disc);
  EXPECT_FALSE(is_near(picture(150, 52), ink_of::endo, 2));
  EXPECT_TRUE(is_near(picture(150, 47), ink_of::endo, 2));
}

TEST(Scene3d, TheScaleBarIsAsLongAsItSays) {
  Scene3d scene;
  scene.add(ball(25), {255, 255, 255});
  Canvas canvas(300, 300);
  scene.draw(canvas, {0, 0, 300, 300}, {}, 0.5);
  // 0.22 of 150 mm is 33 mm: the bar says 20 mm, 40 points.
  EXPECT_EQ(spot_of(canvas.pixels(), ink_of::text, Panel{0, 290, 300, 2}, 2).width(), 40);
}

TEST(Scene3d, NearThingsHideFarOnes) {
  Scene3d scene;
  scene.add_point({0, 10, 0}, ink_of::epi, 10);  // farther along +y
  scene.add_point({0, -10, 0}, ink_of::endo, 10);
  Canvas canvas(100, 100);
  scene.draw(canvas, {0, 0, 100, 100}, {0, 0}, 1);
  EXPECT_EQ(spot_of(canvas.pixels(), ink_of::epi, Panel{44, 44, 12, 12}).count, 0);
  EXPECT_GT(spot_of(canvas.pixels(), ink_of::endo, Panel{44, 44, 12, 12}).count, 100);
}

TEST(Scene3d, PatientStandsUprightWithHisLeftToTheRight) {
  Scene3d scene;
  scene.add_point({0, 0, 0}, ink_of::quiet, 3);
  scene.add_point({40, 0, 0}, ink_of::endo, 3);
  scene.add_point({0, 0, 40}, ink_of::epi, 3);
  Canvas canvas(100, 100);
  scene.draw(canvas, {0, 0, 100, 100}, {0, 0}, 1);
  const io::Picture p = canvas.pixels();
  EXPECT_GT(spot_of(p, ink_of::endo).x, spot_of(p, ink_of::quiet).x + 35);
  EXPECT_LT(spot_of(p, ink_of::epi).y, spot_of(p, ink_of::quiet).y - 35);
}

TEST(Scene3d, DrawsTheOuterFacesOfVoxelsAlone) {
  Image image(cube_of(6));
  for (int k = 1; k < 4; ++k)
    for (int j = 2; j < 3; ++j)
      for (int i = 1; i < 5; ++i) image(i, j, k) = 1;  // 4 x 1 x 3
  Scene3d scene;
  scene.add_voxels(image, [](float v) { return v > 0 ? std::optional(io::Colour{255, 255, 255}) : std::nullopt; });
  Canvas canvas(200, 200);
  canvas.rectangle({0, 0, 200, 200}, ink_of::endo);
  scene.draw(canvas, {0, 0, 200, 200}, {0, 0}, 0.1);
  const Panel above{0, 0, 200, 170};  // the scale stands below
  const double hidden = 200 * 170 - spot_of(canvas.pixels(), ink_of::endo, above, 2).count;
  EXPECT_NEAR(hidden, 40 * 30, 150);  // and the seam around it
}

TEST(SliceMap, IsTrueToTheSpacing) {
  Grid g = cube_of(10);
  g.spacing = {1, 3, 1};
  const SliceMap map = map_of(g, {0, 0, 10, 10}, {0, 0, 300, 300});
  EXPECT_DOUBLE_EQ(map.box.width * 3, map.box.height);
  EXPECT_DOUBLE_EQ(map.at(4.5, 4.5)[0], 150);
  EXPECT_DOUBLE_EQ(map.at(4.5, 4.5)[1], 150);
  Image one(g);
  one(7, 2, 5) = 1;
  const Cutout window = window_around(one, 2);
  EXPECT_EQ(window.i, 5);
  EXPECT_EQ(window.j, 0);
  EXPECT_EQ(window.columns, 5);
  EXPECT_EQ(window.rows, 5);
}

TEST(SliceView, MarksWhereVectorsMeet) {
  const Grid g = cube_of(20);
  Image image(g);
  image(6, 9, 3) = 1;
  const field::VectorField field = towards(g, 6.5);
  SliceView view{&image, &field, 3, 9, 4, nullptr, "a plane that attracts", {}};
  const io::Picture picture = draw_slice_view(view).pixels();
  // The graph of the sign spans 19 mm in x = 530 to 930: 6.5 mm lies at 666.8.
  const Spot mark = spot_of(picture, ink_of::warm, Panel{530, 340, 400, 250});
  EXPECT_GT(mark.count, 20);
  EXPECT_NEAR(mark.x + 0.5, 530 + 6.5 / 19 * 400, 1);
  // The line along row 9 of 20, on both panels: 340 points high from 56 and from 428.
  for (const double top : {56.0, 428.0}) {
    const Spot line = spot_of(picture, ink_of::pink, Panel{24, top, 360, 340});
    EXPECT_NEAR(line.y + 0.5, top + 9.5 / 20 * 340, 1);
    EXPECT_GT(line.width(), 300);
  }
  // The bright voxel at (6, 9) is under the line: the one before it is dark, and it is white beside the line.
  const double column = 24 + 10 + 6.5 * 17, row = 428 + 9.5 * 17;
  EXPECT_TRUE(is_near(picture(static_cast<int>(column), static_cast<int>(row) - 5), {255, 255, 255}, 3));
  EXPECT_TRUE(is_near(picture(static_cast<int>(column) - 17, static_cast<int>(row) - 5), {0, 0, 0}, 3));
}

TEST(SliceView, DrawsTheWaysOfParticles) {
  const Grid g = cube_of(20);
  const Image image(g);
  const field::VectorField field = towards(g, 6.5);
  SliceView view{&image, &field, 3, 9, 4, nullptr, "", {}, {{{2, 4}, {15, 4}}, {{10, 12}, {10, 17}}}};
  const io::Picture picture = draw_slice_view(view).pixels();
  // 20 voxels in 340 points from (34, 428).
  const auto at = [](double i, double j) { return Vec2(34 + (i + 0.5) * 17, 428 + (j + 0.5) * 17); };
  const Vec2 from = at(2, 4), to = at(15, 4), end = at(10, 17);
  const Spot way = spot_of(picture, ink_of::light, Panel{34, 428, 340, 120}, 60);
  EXPECT_NEAR(way.left, from[0], 2);
  EXPECT_NEAR(way.right, to[0], 4);  // the dot at its end hides the rest
  EXPECT_NEAR(way.y + 0.5, from[1], 1);
  const Spot rest = spot_of(picture, ink_of::epi, Panel{end[0] - 5, end[1] - 5, 10, 10}, 30);
  EXPECT_GT(rest.count, 5);
  EXPECT_NEAR(rest.x + 0.5, end[0], 1);
}

TEST(SliceView, RefusesASliceThatIsNotThere) {
  const Grid g = cube_of(5);
  Image image(g, 1.f);
  const field::VectorField field = towards(g, 2);
  EXPECT_THROW(draw_slice_view({&image, &field, 5, 0, 1, nullptr, "", {}}), OptionError);
}

TEST(FieldGrid, DrawsEveryField) {
  const Grid g = cube_of(12);
  const std::vector<NamedField> fields{{"one", towards(g, 3)}, {"two", towards(g, 8)}};
  const io::Picture picture = draw_field_grid(fields, 2, 4, 5, "two").pixels();
  // The length along the row is 0 at the plane: the blue line touches the axis there. Panels from x = 56 and 390.
  for (const auto& [left, at] : {std::pair{56.0, 3.0}, {390.0, 8.0}}) {
    const Spot foot = spot_of(picture, ink_of::endo, Panel{left, 56 + 250 + 22 + 66, 250, 4}, 60);
    EXPECT_GT(foot.count, 0);
    EXPECT_NEAR(foot.x + 0.5, left + at / 11 * 250, 4);
  }
}

TEST(Sections, CutABallInCircles) {
  Grid g = cube_of(41);
  g.origin = Vec3::Constant(-20);
  const Image image(g, 0.1f);
  const NamedSurface surface{"ball", ball(14), ink_of::epi};
  const io::Picture picture = draw_sections_of(image, {&surface, 1}, "ball").pixels();
  // Twelve of the 29 slices; windows of 37 voxels in 210 points. The seventh lies one below the middle or on it.
  const double point = 210.0 / 37;
  const Spot ring = spot_of(picture, ink_of::epi, Panel{24 + 222 * 2, 80 + 240, 210, 210}, 60);
  EXPECT_NEAR(ring.width(), 2 * 14 * point, 0.06 * 2 * 14 * point);
  EXPECT_NEAR(ring.width(), ring.height(), 3);
  EXPECT_NEAR(ring.x + 0.5, 24 + 222 * 2 + 105, 2);
  // The first slice only touches the ball.
  EXPECT_LT(spot_of(picture, ink_of::epi, Panel{24, 80, 210, 210}, 60).width(), 0.5 * ring.width());
}

TEST(Scatter, PutsParticlesAtTheirDistance) {
  const std::vector<double> distances{-2, -2, -2, 0.5, 0.5, 3};
  const io::Picture picture = draw_scatter(distances, "").pixels();
  // y from -2.1 to 3.1 in 330 points from 386 upwards; x from 0 to 6 in 640.
  const auto y_of = [](double d) { return 386 - (d + 2.1) / 5.2 * 330; };
  for (int n = 0; n < 6; ++n) {
    const double x = 64 + n / 6.0 * 640, y = y_of(distances[static_cast<std::size_t>(n)]);
    EXPECT_GT(spot_of(picture, ink_of::endo, Panel{x - 4, y - 4, 9, 9}, 60).count, 1) << n;
  }
  EXPECT_GT(spot_of(picture, ink_of::text, Panel{100, y_of(0) - 1, 500, 2}, 120).width(), 480) << "the zero line";
  EXPECT_THROW(draw_scatter({}, ""), InputError);
}

TEST(History, StacksParticlesByDistance) {
  // All far in the first step; half of them near in the last.
  std::vector<std::array<int, 4>> history;
  for (int n = 0; n <= 100; ++n) history.push_back({n / 2, n / 2, n / 2, 100 - n / 2});
  const io::Picture picture = draw_history(history, "").pixels();
  const Panel right{700, 56, 3, 330}, left{70, 56, 3, 330};
  EXPECT_NEAR(spot_of(picture, viridis(0.05), right).height(), 165, 6);
  EXPECT_LT(spot_of(picture, viridis(0.05), left).height(), 12);
  EXPECT_NEAR(spot_of(picture, viridis(1), left).height(), 325, 12);
}

TEST(Areas, ColoursTrianglesByShape) {
  const io::Picture even = draw_areas(mesh::icosphere(1), "even").pixels();
  TriMesh flat = mesh::icosphere(1);
  for (Vec3& p : flat.vertices) p[0] *= 0.05;
  const io::Picture thin = draw_areas(flat, "flat").pixels();
  const Panel mesh{650, 50, 430, 500};
  EXPECT_GT(spot_of(even, viridis(1), mesh, 40).count, 20000);
  EXPECT_LT(spot_of(thin, viridis(1), mesh, 40).count, spot_of(even, viridis(1), mesh, 40).count / 4);
}

TEST(Cycle, ShowsGatesAtOneScale) {
  const std::vector<std::vector<NamedSurface>> walls{
      {{"large", ball(30), {255, 0, 255}}, {"small", ball(15), {255, 0, 255}}}};
  const io::Picture picture = draw_cycle(walls, "").pixels();
  const auto disc = [&](double left) {
    int count = 0;
    for (int y = 56; y < 190; ++y)
      for (int x = static_cast<int>(left); x < left + 150; ++x) count += picture(x, y)[1] < 40 && picture(x, y)[0] > 90;
    return count;
  };
  EXPECT_NEAR(disc(24) / static_cast<double>(disc(174)), 4, 0.3);
}

TEST(Curves, HaveABandAsWideAsTheInterval) {
  const std::vector<double> time{0, 100, 200};
  const NamedCurve curve{"volume", {50, 50, 50}, {10, 10, 10}, ink_of::endo};
  const io::Picture picture = draw_curves(time, "ms", {&curve, 1}, "").pixels();
  // 0 to 63 mL in 330 points: 20 mL are 105.
  const io::Colour band{204, 227, 240};
  EXPECT_NEAR(spot_of(picture, band, Panel{180, 56, 40, 330}, 8).height(), 20 / 63.0 * 330, 3);
  EXPECT_NEAR(spot_of(picture, ink_of::endo, Panel{180, 56, 40, 330}).y + 0.5, 386 - 50 / 63.0 * 330, 1.2);
}

TEST(Curves, AreDrawnAsFarAsTheirTimesAreKnown) {
  const std::vector<double> time{0, 100};
  const NamedCurve curve{"volume", {50, 50, 50}, {10, 10, 10}, ink_of::endo},
      known{"volume", {50, 50}, {10, 10}, ink_of::endo};
  EXPECT_EQ(draw_curves(time, "ms", {&curve, 1}, "").pixels().pixels,
            draw_curves(time, "ms", {&known, 1}, "").pixels().pixels);
}

TEST(Evolution, ParticlesThatStoppedAreRed) {
  EvolutionFrame frame{3, mesh::icosphere(2), std::vector<bool>(162)};
  for (Vec3& p : frame.mesh.vertices) p = Vec3::Constant(10) + 8 * p;
  for (std::size_t v = 0; v < 162; ++v) frame.stopped[v] = frame.mesh.vertices[v][2] > 10.5;
  Image border(cube_of(21));
  const io::Picture picture = draw_evolution({&frame, 1}, border, "").pixels();
  const Panel panel{24, 64, 290, 270};
  const Spot red = spot_of(picture, ink_of::epi, panel, 30), blue = spot_of(picture, ink_of::endo, panel, 30);
  EXPECT_GT(red.count, 100);
  EXPECT_GT(blue.count, 100);
  EXPECT_LT(red.y, blue.y - 40);
}

TEST(Film, OfTheEvolutionKeepsItsScale) {
  std::vector<EvolutionFrame> frames;
  for (const double radius : {20.0, 10.0})
    frames.push_back({static_cast<int>(radius), ball(radius), std::vector<bool>(2562)});
  frames[1].stopped.assign(2562, true);
  const Film film = film_of_evolution(frames, Image(cube_of(5)), "");
  ASSERT_EQ(film.frames.size(), 12u) << "the last frame stays for ten more";
  const Panel below{24, 70, 512, 470};
  const Spot first = spot_of(film.frames[0].pixels(), ink_of::endo, below, 40);
  const Spot last = spot_of(film.frames[1].pixels(), ink_of::epi, below, 40);
  EXPECT_NEAR(first.width() / last.width(), 2, 0.05);
  EXPECT_NEAR(first.x, last.x, 2) << "and its place";
  EXPECT_NEAR(first.y, last.y, 6);
  EXPECT_EQ(spot_of(film.frames[11].pixels(), ink_of::epi, below, 40).count, last.count);
}

TEST(Film, OfABeatGoesThroughItsGates) {
  // Two gates, 30 and 20 mm: the first picture shows the large one, the 21st the small one.
  const std::vector<std::vector<TriMesh>> walls{{ball(20), ball(30)}};
  const io::Colour colours[] = {{255, 0, 255}};
  const Film film = film_of_beat(walls, colours, 1000, "");
  ASSERT_EQ(film.frames.size(), 40u);
  const auto width = [&](std::size_t n) {
    int least = 1000, most = 0;
    const io::Picture picture = film.frames[n].pixels();
    for (int y = 80; y < 540; ++y)
      for (int x = 24; x < 536; ++x)
        if (picture(x, y)[1] < 40 && picture(x, y)[0] > 80) least = std::min(least, x), most = std::max(most, x);
    return most - least;
  };
  EXPECT_NEAR(width(20) / double(width(0)), 1.5, 0.03);
  EXPECT_GT(width(10), width(0) + 5);
  EXPECT_THROW(film_of_beat({}, {}, 0, ""), InputError);
}

TEST(Scene3d, SmoothSurfacesHaveNoEdges) {
  // A coarse ball: flat faces are few colours in large areas, smooth ones run into each other.
  TriMesh coarse = mesh::icosphere(1);
  for (Vec3& p : coarse.vertices) p *= 25;
  const auto colours_of = [&](Scene3d::Look look) {
    Scene3d scene;
    scene.add(coarse, {200, 100, 50}, 1, look);
    Canvas canvas(200, 200);
    scene.draw(canvas, {0, 0, 200, 200}, {}, 0.3);
    const io::Picture picture = canvas.pixels();
    int steps = 0;  // neighbours that differ by much
    for (int y = 40; y < 160; ++y)
      for (int x = 41; x < 160; ++x) {
        const double r = std::hypot(x - 100, y - 100);
        if (r < 55) steps += std::abs(picture(x, y)[0] - picture(x - 1, y)[0]) > 6;
      }
    return steps;
  };
  EXPECT_GT(colours_of(Scene3d::Look::shaded), 200);
  EXPECT_LT(colours_of(Scene3d::Look::smooth), 20);
}

TEST(Instances, FarOnesAreCoarser) {
  std::vector<TriMesh> levels;
  for (const int level : {4, 3, 2, 1}) levels.push_back(mesh::icosphere(level));
  const io::Picture picture = draw_instances(levels, "").pixels();
  // The nearest row is below, the farthest above: the coarsest level has the brightest colour.
  const auto brightness = [&](double from, double to) {
    double sum = 0;
    int count = 0;
    for (int y = int(from); y < int(to); ++y)
      for (int x = 300; x < 1000; ++x) {
        const io::Colour& c = picture(x, y);
        if (c[0] > 245 && c[1] > 245 && c[2] > 245) continue;
        sum += c[0], ++count;  // red: from 59 in the finest to 200 and more in the coarsest
      }
    return count > 0 ? sum / count : 0;
  };
  EXPECT_GT(brightness(180, 215), brightness(560, 700) + 40);
  EXPECT_THROW(draw_instances({}, ""), InputError);
}

TEST(Contours, ShowWhatResamplingDoes) {
  Image image(cube_of(40), 0.2f);
  ContourView view;
  view.image = &image;
  view.slice = 20;
  view.start = circle_contour({20, 20}, 15, 2);
  view.found = circle_contour({20, 20}, 10, 2);
  view.unsampled = circle_contour({20, 20}, 10, 8);
  view.resampled = view.found;
  const io::Picture picture = draw_contours(view).pixels();
  // In the middle panel: 8 points of the one, 31 of the other, on one circle.
  const Panel middle{554, 72, 450, 500};
  const Spot few = spot_of(picture, ink_of::light, middle, 40), many = spot_of(picture, ink_of::epi, middle, 40);
  EXPECT_GT(few.count, 8 * 20);
  EXPECT_GT(many.count, 31 * 8);
  EXPECT_NEAR(few.width(), many.width(), 6);
}

TEST(Contours, AreDrawnOverTheirPixels) {
  Image image(cube_of(40), 0.2f);
  ContourView view;
  view.image = &image;
  view.slice = 20;
  view.start = circle_contour({20, 20}, 15, 2);
  view.found = circle_contour({20, 20}, 10, 2);
  std::vector<std::optional<Contour>> stack(40);
  for (std::size_t k = 10; k < 30; ++k) stack[k] = view.found;
  view.stacks = {{ink_of::pink, stack}};
  const io::Picture picture = draw_contours(view).pixels();
  // The window holds 15 pixels about (20, 20) and 5 more; 500 points are its height.
  const Spot start = spot_of(picture, ink_of::light, Panel{24, 72, 500, 500}, 40);
  const Spot found = spot_of(picture, ink_of::epi, Panel{24, 72, 500, 500}, 40);
  EXPECT_NEAR(start.width() / found.width(), 1.5, 0.05);
  EXPECT_NEAR(start.x, found.x, 2);
  EXPECT_NEAR(start.y, found.y, 2);
  // 20 mm across and 19 mm high, seen from the side.
  const Spot tube = spot_of(picture, ink_of::pink, Panel{560, 72, 490, 500}, 30);
  EXPECT_GT(tube.height(), 200);
  EXPECT_NEAR(tube.width() / tube.height(), 20 / (19 * std::cos(0.349) + 20 * std::sin(0.349)), 0.06);
}

TEST(Voxels, AreColouredByTheirSet) {
  Image one(cube_of(8)), other(cube_of(8));
  for (int k = 0; k < 8; ++k)
    for (int i = 0; i < 8; ++i) (i < 4 ? one : other)(i, 0, k) = 1;
  const NamedVoxels sets[] = {{"left", one, {255, 0, 255}, 1}, {"right", other, {0, 255, 0}, 1}};
  const io::Picture picture = draw_voxels(sets, "").pixels();
  double left = 0, right = 0;
  int lefts = 0, rights = 0;
  for (int y = 60; y < 680; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const io::Colour& c = picture(x, y);
      if (c[1] < 10 && c[0] > 90) left += x, ++lefts;
      if (c[0] < 10 && c[1] > 90) right += x, ++rights;
    }
  ASSERT_GT(lefts, 1000);
  ASSERT_GT(rights, 1000);
  EXPECT_LT(left / lefts + 100, right / rights);
}

TEST(Smoothing, ShowsWhichMeshIsSmoother) {
  TriMesh rough = mesh::icosphere(3);
  for (std::size_t v = 0; v < rough.vertices.size(); v += 7) rough.vertices[v] *= 1.06;
  const io::Picture picture = draw_smoothing(rough, mesh::icosphere(3), "").pixels();
  const auto bright = [&](double left) { return spot_of(picture, viridis(0.6), Panel{left, 60, 460, 460}, 60).count; };
  EXPECT_GT(bright(24), 10 * (bright(494) + 1));
}

TEST(Field3d, LinesRunToTheBorder) {
  const Grid g = cube_of(21);
  Image border(g);
  field::VectorField field(g);
  for (int k = 0; k < 21; ++k)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 21; ++i) {
        const Vec3 way = Vec3(10, 10, 10) - Vec3(i, j, k);
        const Vec3 pull = way.norm() > 0 ? Vec3((way.norm() - 5) * way.normalized()) : Vec3(Vec3::Zero());
        const std::size_t n = g.index(i, j, k);
        field.x[n] = static_cast<float>(pull[0]), field.y[n] = static_cast<float>(pull[1]);
        field.z[n] = static_cast<float>(pull[2]);
        border(i, j, k) = std::abs(way.norm() - 5) < 0.5 ? 1.f : 0.f;
      }
  const io::Picture picture = draw_field_3d(field, border, "").pixels();
  EXPECT_GT(spot_of(picture, viridis(0.9), Panel{24, 60, 770, 600}, 60).count, 100) << "long vectors outside";
  EXPECT_GT(spot_of(picture, viridis(0.1), Panel{24, 60, 770, 600}, 60).count, 100) << "short ones at the border";
  EXPECT_THROW(draw_field_3d(field, Image(g), ""), InputError);
}

}  // namespace
}  // namespace dynasurf::show
