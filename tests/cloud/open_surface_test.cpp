#include "dynasurf/cloud/detail/open_surface.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "dynasurf/cloud/detail/patch.hpp"
#include "dynasurf/cloud/detail/triangle_marks.hpp"
#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::cloud {
namespace {

using std::numbers::pi;
using Line = std::vector<Vec3>;

/// An open surface of which everything is known.
struct Sheet {
  std::string name;
  std::function<Vec3(double, double)> place;     // of two parameters from 0 to 1, about evenly by area
  std::function<bool(double, double)> is_there;  // false in a hole
  std::function<double(const Vec3&)> distance;   // to the sheet as it would go on
  std::vector<Line> rims;                        // the outer one first
};

Line along(const std::function<Vec3(double)>& place) {
  Line line;
  for (int i = 0; i < 2000; ++i) line.push_back(place(i / 2000.0));
  return line;
}

/// Once around the rectangle between two corners, for t from 0 to 1.
Eigen::Vector2d around(double t, double low_u, double low_v, double high_u, double high_v) {
  const double side = 4 * t, along = side - std::floor(side);
  const double u[5] = {low_u, high_u, high_u, low_u, low_u}, v[5] = {low_v, low_v, high_v, high_v, low_v};
  const auto k = static_cast<std::size_t>(side);
  return {u[k] + along * (u[k + 1] - u[k]), v[k] + along * (v[k + 1] - v[k])};
}

bool everywhere(double, double) { return true; }

Sheet terrain() {
  const auto height = [](double x, double y) { return 0.2 * std::sin(3 * x) * std::cos(2 * y) + 0.1 * x * y; };
  const auto place = [height](double u, double v) { return Vec3(2 * u, 1.5 * v, height(2 * u, 1.5 * v)); };
  return {"terrain",
          place,
          everywhere,
          [height](const Vec3& p) {
            const double sx = 0.6 * std::cos(3 * p[0]) * std::cos(2 * p[1]) + 0.1 * p[1];
            const double sy = -0.4 * std::sin(3 * p[0]) * std::sin(2 * p[1]) + 0.1 * p[0];
            return std::abs(p[2] - height(p[0], p[1])) / std::sqrt(1 + sx * sx + sy * sy);
          },
          {along([place](double t) {
            const auto at = around(t, 0, 0, 1, 1);
            return place(at[0], at[1]);
          })}};
}

/// A sphere of radius 1 down to an angle from its pole.
Sheet cap(const std::string& name, double angle) {
  const double deep = 1 - std::cos(angle);
  const auto place = [deep](double u, double v) {
    const double z = 1 - deep * v, across = std::sqrt(1 - z * z);
    return Vec3(across * std::cos(2 * pi * u), across * std::sin(2 * pi * u), z);
  };
  return {name, place, everywhere, [](const Vec3& p) { return std::abs(p.norm() - 1); }, {along([place](double t) {
            return place(t, 1);
          })}};
}

/// A wavy wall with a window.
Sheet front() {
  const auto off = [](double x) { return 0.06 * std::sin(5 * x); };
  const auto place = [off](double u, double v) { return Vec3(2 * u, off(2 * u), 1.2 * v); };
  const auto outline = [place](double low_u, double low_v, double high_u, double high_v) {
    return along([=](double t) {
      const auto at = around(t, low_u, low_v, high_u, high_v);
      return place(at[0], at[1]);
    });
  };
  return {"front",
          place,
          [](double u, double v) { return std::abs(u - 0.45) > 0.1 || std::abs(v - 0.55) > 0.15; },
          [off](const Vec3& p) {
            const double slope = 0.3 * std::cos(5 * p[0]);
            return std::abs(p[1] - off(p[0])) / std::sqrt(1 + slope * slope);
          },
          {outline(0, 0, 1, 1), outline(0.35, 0.4, 0.55, 0.7)}};
}

constexpr double noise_percent = 0.3;

PointCloud scan_of(const Sheet& sheet, std::size_t count, std::uint64_t seed = 1) {
  synthetic::Random random(seed);
  PointCloud cloud;
  Eigen::AlignedBox3d box;
  while (cloud.points.size() < count) {
    const double u = random.uniform(), v = random.uniform();
    if (!sheet.is_there(u, v)) continue;
    cloud.points.push_back(sheet.place(u, v));
    box.extend(cloud.points.back());
  }
  const double noise = noise_percent / 100 * box.diagonal().norm();
  for (Vec3& p : cloud.points)
    for (int a = 0; a < 3; ++a) p[a] += noise / std::sqrt(3.0) * random.normal();
  return cloud;
}

double distance_to(const Vec3& p, const Line& line) {
  double least = 1e300;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Vec3 &a = line[i], along = line[(i + 1) % line.size()] - a;
    const double t = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
    least = std::min(least, (p - a - t * along).norm());
  }
  return least;
}

struct Off {
  double mean = 0, largest = 0;
};

Off off_between(const Line& from, const Line& to) {
  Off off;
  for (const Vec3& p : from) {
    const double d = distance_to(p, to);
    off.mean += d / static_cast<double>(from.size());
    off.largest = std::max(off.largest, d);
  }
  return off;
}

/// The boundary loops, the longest first.
std::vector<Line> outlines(const TriMesh& mesh) {
  std::vector<Line> lines;
  for (const Loop& loop : loops_of(mesh)) {
    lines.emplace_back();
    for (const std::uint32_t v : loop) lines.back().push_back(mesh.vertices[v]);
  }
  const auto length = [](const Line& line) {
    double sum = 0;
    for (std::size_t i = 0; i < line.size(); ++i) sum += (line[(i + 1) % line.size()] - line[i]).norm();
    return sum;
  };
  std::sort(lines.begin(), lines.end(), [&](const Line& a, const Line& b) { return length(a) > length(b); });
  return lines;
}

/// Everything that a level of an open surface has to be.
void expect_like(const Result& result, const Sheet& sheet, std::size_t loops) {
  const double spacing = result.facts.spacing, noise = noise_percent / 100 * result.facts.diagonal;
  for (const Level& level : result.levels) {
    SCOPED_TRACE(sheet.name + ", " + std::to_string(level.triangles_asked));
    const Certificate& c = level.certificate;
    EXPECT_TRUE(c.sound_open());
    EXPECT_EQ(c.components, 1);
    EXPECT_EQ(c.genus, 0);
    EXPECT_GE(c.triangles + 2, static_cast<std::size_t>(level.triangles_asked));
    EXPECT_LE(c.triangles, static_cast<std::size_t>(level.triangles_asked));
    ASSERT_EQ(c.boundary_loops, static_cast<int>(loops));
    const std::vector<Line> lines = outlines(level.mesh);
    ASSERT_EQ(lines.size(), loops);
    // What chords of this many triangles leave out: a sixteenth of an edge.
    const double chord = std::sqrt(c.area / static_cast<double>(c.triangles)) / 16;
    double mean = 0;
    for (const Vec3& p : level.mesh.vertices) mean += sheet.distance(p) / static_cast<double>(c.vertices);
    EXPECT_LT(mean, 0.5 * (noise + chord));
    for (std::size_t i = 0; i < loops; ++i) {
      const Off there = off_between(lines[i], sheet.rims[i]), back = off_between(sheet.rims[i], lines[i]);
      EXPECT_LT(std::max(there.mean, back.mean), 0.6 * spacing + chord);
      EXPECT_LT(std::max(there.largest, back.largest), 2 * spacing + 4 * chord);
    }
  }
}

std::string notes_of(const Result& result) {
  std::string text;
  for (const Note& n : result.notes) text += n.code + ": " + n.message + "\n";
  return text;
}

Result reconstructed(const Sheet& sheet, BoundaryRule rule, std::size_t points = 12000) {
  Options options;
  options.triangles = {2400, 800, 200};
  options.boundary = rule;
  return reconstruct(scan_of(sheet, points), options);
}

class EveryOpenSheet : public testing::TestWithParam<Sheet> {};

TEST_P(EveryOpenSheet, EndsWhereThePointsEnd) {
  for (const BoundaryRule rule : {BoundaryRule::automatic, BoundaryRule::keep, BoundaryRule::trim}) {
    const Result result = reconstructed(GetParam(), rule);
    EXPECT_EQ(result.facts.boundary, rule == BoundaryRule::trim ? BoundaryRule::trim : BoundaryRule::keep);
    EXPECT_NE(verdict_of(result), Verdict::fail) << notes_of(result);
    expect_like(result, GetParam(), rule == BoundaryRule::trim ? GetParam().rims.size() : 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Sheets, EveryOpenSheet,
                         testing::Values(terrain(), cap("cap", pi / 3), cap("half_shell", pi / 2), front()),
                         [](const auto& one) { return one.param.name; });

// Levels of detail are looked at one beside the other, and grow into each other.
TEST(OpenLevels, KeepTheRimOfTheFinest) {
  const Result result = reconstructed(front(), BoundaryRule::trim);
  const std::vector<Line> finest = outlines(result.levels[0].mesh);
  for (std::size_t n = 1; n < result.levels.size(); ++n) {
    const TriMesh &coarse = result.levels[n].mesh, &fine = result.levels[n - 1].mesh;
    const std::vector<Line> lines = outlines(coarse);
    ASSERT_EQ(lines.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_LT(off_between(finest[i], lines[i]).mean, 0.5 * result.facts.spacing);
      EXPECT_LT(off_between(lines[i], finest[i]).mean, 0.5 * result.facts.spacing);
    }
    const LodTransition growing = lod_transition(coarse, fine);
    const TriMesh start = at_transition(growing, 0), half = at_transition(growing, 0.5);
    EXPECT_EQ(loops_of(half).size(), 2u);
    for (const Line& line : outlines(start))
      for (const Vec3& p : line) EXPECT_LT(std::min(distance_to(p, lines[0]), distance_to(p, lines[1])), 1e-9);
  }
}

TEST(Boundary, IsClosedForBodies) {
  using synthetic::CloudShape;
  for (const auto& [shape, missing] : {std::pair{CloudShape::vase, 0.0},
                                       {CloudShape::torus, 0.0},
                                       {CloudShape::sphere, 20.0},
                                       {CloudShape::vase, 20.0}}) {
    Options options;
    options.triangles = {800};
    const PointCloud cloud = synthetic::make_cloud({.shape = shape, .points = 12000, .missing_percent = missing});
    const Result automatic = reconstruct(cloud, options);
    options.boundary = BoundaryRule::close;
    const Result closed = reconstruct(cloud, options);
    EXPECT_EQ(automatic.facts.boundary, BoundaryRule::close);
    EXPECT_TRUE(automatic.levels[0].certificate.watertight());
    EXPECT_EQ(automatic.levels[0].mesh.vertices, closed.levels[0].mesh.vertices);
    EXPECT_EQ(automatic.levels[0].mesh.triangles, closed.levels[0].mesh.triangles);
    EXPECT_EQ(notes_of(automatic).find("boundary=auto took close") != std::string::npos, missing > 0);
  }
}

TEST(Boundary, IsOpenedAtTheHoleOfABodyWhereAskedFor) {
  const PointCloud torn =
      synthetic::make_cloud({.shape = synthetic::CloudShape::sphere, .points = 12000, .missing_percent = 20});
  for (const BoundaryRule rule : {BoundaryRule::keep, BoundaryRule::trim}) {
    Options options;
    options.triangles = {800};
    options.boundary = rule;
    const Result result = reconstruct(torn, options);
    const Certificate& c = result.levels[0].certificate;
    EXPECT_TRUE(c.sound_open());
    EXPECT_EQ(c.boundary_loops, 1);
    EXPECT_NEAR(c.area, 0.8 * 4 * pi, 0.04 * 4 * pi);
    EXPECT_EQ(verdict_of(result), Verdict::ok) << notes_of(result);
    EXPECT_FALSE(is_watertight(result));
  }
}

// A dome to stand on: half a ball, on a disc.
TEST(Boundary, IsClosedByAFlatLidWhereAskedFor) {
  const auto volume_by = [](LidRule lid) {
    Options options;
    options.triangles = {2400};
    options.boundary = BoundaryRule::close;
    options.lid = lid;
    const Result result = reconstruct(scan_of(cap("half_shell", pi / 2), 12000), options);
    EXPECT_TRUE(is_watertight(result));
    return mesh::volume_mm3(result.levels[0].mesh);
  };
  const double half = 2 * pi / 3;
  // A rim that were half a spacing of 1/43 off, all the way round, would be 1.7 % of it.
  EXPECT_NEAR(volume_by(LidRule::flat), half, 0.01 * half);
  EXPECT_GT(volume_by(LidRule::smooth), 1.8 * half) << "the other half of the ball";
}

TEST(Boundary, IsNoneWhereThePointsHoldAllOfTheSurface) {
  const PointCloud whole = synthetic::make_cloud({.shape = synthetic::CloudShape::torus, .points = 12000});
  for (const char* rule : {"keep", "trim"}) {
    Options options;
    options.triangles = {800};
    set_option(options, std::string("boundary=") + rule);
    const Result result = reconstruct(whole, options);
    EXPECT_TRUE(result.levels[0].certificate.watertight());
    EXPECT_EQ(result.facts.boundary, BoundaryRule::close);
    EXPECT_NE(notes_of(result).find("the points hold all of the surface"), std::string::npos);
  }
}

// Nothing but custom tells the upper side of a terrain.
TEST(Boundary, OfATerrainRunsRoundItsUpperSide) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    Options options;
    options.triangles = {640};
    const Result result = reconstruct(scan_of(terrain(), 6000, seed), options);
    EXPECT_GT(facing_of(result.levels[0].mesh)[2], 0.8) << seed;
  }
}

TEST(Boundary, GetsNoFlatLidWhereItStaysOpen) {
  Options options;
  options.lid = LidRule::flat;
  EXPECT_NO_THROW(check(options));
  for (const BoundaryRule rule : {BoundaryRule::keep, BoundaryRule::trim}) {
    options.boundary = rule;
    EXPECT_THROW(check(options), OptionError);
  }
  options = preset("thesis");
  options.lid = LidRule::flat;
  EXPECT_THROW(check(options), OptionError);
}

// A spike that stands in a bowl and looks out of it: what closes the bowl goes around.
TEST(Boundary, IsClosedSmoothlyWhereAFlatLidWouldCross) {
  PointCloud cloud;
  for (int n = 0; n < 12000; ++n) {  // golden angles
    const double turn = n * pi * (3 - std::sqrt(5.0)), c = std::cos(turn), s = std::sin(turn);
    const double across = std::sqrt((n + 0.5) / 12000);  // of the bowl's radius
    const double low = -std::sqrt(1 - across * across);
    const double spike = 1.8 * std::exp(-std::pow(across / 0.25, 2));
    cloud.points.push_back({across * c, across * s, low + spike});
  }
  Options options;
  options.triangles = {2400};
  options.boundary = BoundaryRule::close;
  options.lid = LidRule::flat;
  const Result result = reconstruct(cloud, options);
  EXPECT_TRUE(is_watertight(result));
  EXPECT_NE(notes_of(result).find("cloud.lid: flat lids would cross the surface"), std::string::npos)
      << notes_of(result);
  EXPECT_NE(notes_of(result).find("closed smoothly"), std::string::npos) << notes_of(result);
}

TEST(Boundary, IsNotOpenedByTheThesisRecipe) {
  Options options = preset("thesis");
  options.boundary = BoundaryRule::keep;
  EXPECT_THROW(check(options), OptionError);
}

}  // namespace
}  // namespace dynasurf::cloud
