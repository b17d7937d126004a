#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/psf_fit/blur_fit.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::psf_fit {
namespace {

struct Fitted {
  Study study;
  FittedBeat beat;
};

/// A heart without noise on voxels that the fit takes as they are, fitted from its true surfaces.
Fitted fitted_heart() {
  synthetic::VirtualPatient o;
  o.edv_ml = 90, o.ef_percent = 50, o.wall_ml = 100;
  o.gates = 4;
  o.fwhm_mm = 10;
  o.noise.peak_counts = 0;
  o.right_ventricle = 0;
  o.pose.tilt_deg = 12;
  o.lattice = {28, 28, 24, 4.8, 4.8, 4.8};
  synthetic::Phantom phantom = synthetic::make_phantom(o);
  FitStart start;
  for (const synthetic::TrueGate& gate : phantom.truth) {
    start.endo.push_back(gate.endo), start.epi.push_back(gate.epi);
    heart::BasePlane base;
    base.point = gate.epi.vertices.back();
    base.normal = (gate.epi.vertices.back() - gate.epi.vertices.front()).normalized();
    start.base.emplace_back(base);
  }
  start.axis = start.base.front()->normal;
  start.lateral = phantom.study.grid().direction.col(0);
  BlurFit options;
  options.fwhm_mm = 10;
  FittedBeat beat = fit_through_blur(phantom.study, start, options);
  return {std::move(phantom.study), std::move(beat)};
}

TEST(FitImages, LieWhereTheStudyDoesAndShowAllThatItExplains) {
  const auto [study, beat] = fitted_heart();
  const FitImages& images = beat.images;
  ASSERT_EQ(images.data.size(), study.gates.size());
  ASSERT_EQ(images.model.size(), study.gates.size());
  const Grid& grid = images.weight.grid;
  ASSERT_TRUE(grid.spacing.isApprox(study.grid().spacing))
      << "voxels were joined: the comparison below wants them alone";
  float most = 0;
  double squares = 0, count = 0, brightest = 0;
  double scale = 0;  // of the study's values in parts of healthy muscle
  for (std::size_t g = 0; g < study.gates.size(); ++g)
    for (int k = 0; k < grid.dims[2]; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i) {
          const std::size_t n = grid.index(i, j, k);
          const Index3 v = voxel_of(study.grid(), to_grid(study.grid(), to_world(grid, centre_of(grid, {i, j, k}))));
          const auto stored = static_cast<double>(study.gates[g](v[0], v[1], v[2]));
          const auto data = static_cast<double>(images.data[g].values[n]);
          if (data > brightest) brightest = data, scale = data / stored;
          most = std::max(most, images.weight.values[n]);
          ASSERT_GE(images.weight.values[n], 0);
          if (images.weight.values[n] <= 0) continue;
          squares += std::pow(static_cast<double>(images.model[g].values[n]) - data, 2);
          count += 1;
        }
  EXPECT_EQ(most, 1);
  // Healthy muscle is 1; the blur takes a part of it where the wall is thin.
  EXPECT_NEAR(brightest, 1, 0.25);
  EXPECT_LT(std::sqrt(squares / count), 0.01) << "without noise the model explains the image";
  for (int k = 0; k < grid.dims[2]; k += 3)
    for (int i = 0; i < grid.dims[0]; i += 3) {
      const Index3 v = voxel_of(study.grid(), to_grid(study.grid(), to_world(grid, centre_of(grid, {i, 5, k}))));
      EXPECT_NEAR(static_cast<double>(images.data[1](i, 5, k)),
                  scale * static_cast<double>(study.gates[1](v[0], v[1], v[2])), 1e-4);
    }
}

}  // namespace
}  // namespace dynasurf::psf_fit
