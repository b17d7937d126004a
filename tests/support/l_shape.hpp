#pragma once
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "dynasurf/core/study.hpp"

namespace dynasurf::test {

/// A rotation with no axis near those of the patient.
inline Mat3 oblique_rotation() {
  return (Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()) * Eigen::AngleAxisd(-0.4, Vec3::UnitX()))
      .toRotationMatrix();
}

inline Grid oblique_grid(bool left_handed = false) {
  Grid g;
  g.dims = {7, 6, 5};
  g.spacing = {2.5, 3.25, 5.75};
  g.origin = {-31.5, 12.25, 47.75};
  g.direction = oblique_rotation();
  if (left_handed) g.direction.col(2) = -g.direction.col(2);
  return g;
}

/// Brightness of an L-shaped object fixed in the world (near the middle of `oblique_grid`): three arms of different
/// length and value, so that no turn or mirror maps it to itself. `beat` (0..1) dims it.
inline float l_shape_at(const Vec3& world, double beat) {
  const Vec3 p = oblique_rotation().transpose() * (world - Vec3(-31.5, 12.25, 47.75));
  const bool long_arm = p[0] > 2 && p[0] < 14 && p[1] > 2 && p[1] < 6 && std::abs(p[2]) < 7;
  const bool side_arm = p[0] > 2 && p[0] < 6 && p[1] > 2 && p[1] < 14 && std::abs(p[2]) < 7;
  const bool up_arm = p[0] > 2 && p[0] < 6 && p[1] > 2 && p[1] < 6 && std::abs(p[2]) < 19;
  const double value = (long_arm ? 1000 : 0) + (side_arm ? 300 : 0) + (up_arm ? 70 : 0) + 3;
  return static_cast<float>(std::floor(value * (1 - 0.5 * beat)));
}

/// The L on a grid, one volume per gate.
inline Study l_shape_study(const Grid& grid, int gates) {
  Study study;
  study.format = "synthetic";
  study.modality = "NM";
  study.view = View::short_axis;
  study.slice_order = SliceOrder::apex_to_base;
  if (gates > 1) study.cycle_ms = 800;
  for (int g = 0; g < gates; ++g) {
    Image image(grid);
    for (int k = 0; k < grid.dims[2]; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i)
          image(i, j, k) = l_shape_at(to_world(grid, centre_of(grid, {i, j, k})), double(g) / gates);
    study.gates.push_back(std::move(image));
    if (gates > 1) study.time_ms.push_back(800.0 * g / gates);
  }
  return study;
}

/// Every voxel of `study` lies at the world position where its grid says, with the value the object has there.
/// `tolerance_mm` bounds the distance between the voxel centres of both grids.
inline void expect_l_shape(const Study& study, const Study& truth, double tolerance_mm) {
  ASSERT_EQ(study.gates.size(), truth.gates.size());
  const Grid &a = study.grid(), &b = truth.grid();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t g = 0; g < truth.gates.size(); ++g)
    for (int k = 0; k < a.dims[2]; ++k)
      for (int j = 0; j < a.dims[1]; ++j)
        for (int i = 0; i < a.dims[0]; ++i) {
          const Vec3 world = to_world(a, centre_of(a, {i, j, k}));
          const Vec3 there = to_grid(b, world);
          const Index3 v = voxel_of(b, there);
          ASSERT_TRUE(b.contains(v[0], v[1], v[2]));
          ASSERT_LT((centre_of(b, v) - there).norm(), tolerance_mm);
          ASSERT_EQ(study.gates[g](i, j, k), truth.gates[g](v[0], v[1], v[2])) << i << "," << j << "," << k;
        }
}

}  // namespace dynasurf::test
