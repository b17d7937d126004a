#include "dynasurf/dynamics/detail/border_planes.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::dynamics {
namespace {

Grid grid_of(int n) {
  Grid grid;
  grid.dims = {n, n, n};
  grid.spacing = {2, 2, 3};
  return grid;
}

const BorderHit hit{{4, 4, 4}, {7, 8.5, 12.4}};  // entered through the low face of i

TEST(MeetingPoint, LiesOnThePlaneOfTheVoxelAndOnThePath) {
  const Grid grid = grid_of(9);
  const BorderPlanes planes{grid, {{grid.index(4, 4, 4), {0.4F, 0, 0}, {-3, 1, 0}}}};
  const Vec3 direction(5, 1, 0.2), p = meeting_point(grid, &planes, hit, direction);
  EXPECT_NEAR((p - Vec3(8.4, 8, 12)).dot(Vec3(-3, 1, 0)), 0, 1e-6);  // offsets are single precision
  EXPECT_NEAR((p - hit.entry).cross(direction).norm(), 0, 1e-12);
}

TEST(MeetingPoint, StaysInTheVoxel) {
  const Grid grid = grid_of(9);
  for (const float offset : {-30.0F, 30.0F}) {
    const BorderPlanes planes{grid, {{grid.index(4, 4, 4), {offset, 0, 0}, {1, 0, 0}}}};
    const Vec3 p = meeting_point(grid, &planes, hit, {1, 0.1, 0});
    EXPECT_NEAR(p[0], offset < 0 ? 7 : 9, 1e-12);
  }
}

TEST(MeetingPoint, IsAbreastOfTheCentreWhereNothingIsKnown) {
  const Grid grid = grid_of(9);
  EXPECT_LT((meeting_point(grid, nullptr, hit, {2, 0, 0}) - Vec3(8, 8.5, 12.4)).norm(), 1e-12);
  BorderPlanes planes{grid, {}};
  EXPECT_LT((meeting_point(grid, &planes, hit, {2, 0, 0}) - Vec3(8, 8.5, 12.4)).norm(), 1e-12);
  planes.planes = {{grid.index(4, 4, 3), {1, 0, 0}, {1, 0, 0}}};  // of another voxel
  EXPECT_LT((meeting_point(grid, &planes, hit, {2, 0, 0}) - Vec3(8, 8.5, 12.4)).norm(), 1e-12);
  planes.planes = {{grid.index(4, 4, 4), {0, 0, 0}, {0, 1, 0}}};  // the path runs along the plane
  EXPECT_LT((meeting_point(grid, &planes, hit, {2, 0, 0}) - Vec3(8, 8.5, 12.4)).norm(), 1e-12);
  EXPECT_EQ(meeting_point(grid, &planes, hit, {0, 0, 0}), hit.entry);
}

/// Voxels that a sphere passes through, and where it does.
struct SphereBorder {
  Image voxels;
  BorderPlanes planes;
};

SphereBorder sphere_border(double radius_mm) {
  const Grid grid = grid_of(31);
  SphereBorder b{Image(grid), {grid, {}}};
  const Vec3 middle = centre_of(grid, {15, 15, 15});
  for (int k = 0; k < 31; ++k)
    for (int j = 0; j < 31; ++j)
      for (int i = 0; i < 31; ++i) {
        const Vec3 p = centre_of(grid, {i, j, k}) - middle;
        const Vec3 offset = p * (radius_mm / p.norm() - 1);
        if (p.norm() == 0 || (offset.cwiseAbs() - grid.spacing / 2).maxCoeff() > 0) continue;
        const std::size_t v = grid.index(i, j, k);
        b.voxels.values[v] = 1;
        b.planes.planes.push_back({v, offset.cast<float>(), p.cast<float>()});
      }
  return b;
}

/// Mean distance of the vertices from the sphere, mm, for a way of stopping.
double mean_error_mm(const SphereBorder& border, double radius_mm, StopPoint point, const BorderPlanes* planes) {
  const Grid& grid = border.voxels.grid;
  const Vec3 middle = centre_of(grid, {15, 15, 15});
  field::VectorField inwards(grid);
  for (int k = 0; k < 31; ++k)
    for (int j = 0; j < 31; ++j)
      for (int i = 0; i < 31; ++i) {
        const Vec3 v = -(centre_of(grid, {i, j, k}) - middle).normalized() * 0.3;
        const std::size_t n = grid.index(i, j, k);
        inwards.x[n] = static_cast<float>(v[0]), inwards.y[n] = static_cast<float>(v[1]),
        inwards.z[n] = static_cast<float>(v[2]);
      }
  Evolution options;
  options.stop.point = point;
  options.smooth_after.sweeps = 0;
  const EvolutionResult r = evolve(mesh::place(mesh::icosphere(3), border.voxels, {}), inwards, border.voxels, options,
                                   {}, {.planes = planes});
  double sum = 0;
  for (const Vec3& p : r.mesh.vertices) sum += std::abs((p - middle).norm() - radius_mm);
  return sum / static_cast<double>(r.mesh.vertices.size());
}

TEST(Evolve, StopsOnTheSurfaceInsideTheVoxelsWhenItIsTold) {
  const double radius_mm = 20;
  const SphereBorder border = sphere_border(radius_mm);
  const double entry = mean_error_mm(border, radius_mm, StopPoint::entry, nullptr);
  const double centres = mean_error_mm(border, radius_mm, StopPoint::subvoxel, nullptr);
  const double planes = mean_error_mm(border, radius_mm, StopPoint::subvoxel, &border.planes);
  EXPECT_LT(centres, 0.8 * entry);
  EXPECT_LT(planes, 0.4 * entry);
  EXPECT_LT(planes, 0.3);  // of voxels of 2 x 2 x 3 mm: neighbouring planes meet at an angle
  RecordProperty("errors", std::to_string(entry) + " " + std::to_string(centres) + " " + std::to_string(planes));
}

TEST(Evolve, RefusesPlanesOfAnotherGrid) {
  const SphereBorder border = sphere_border(20);
  const BorderPlanes other{grid_of(5), {}};
  EXPECT_THROW(evolve(mesh::place(mesh::icosphere(1), border.voxels, {}), field::VectorField(border.voxels.grid),
                      border.voxels, {}, {}, {.planes = &other}),
               InputError);
}

}  // namespace
}  // namespace dynasurf::dynamics
