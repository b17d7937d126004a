#include "dynasurf/psf_fit/detail/psf_projector.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "psf_fit/round_heart.hpp"

namespace dynasurf::psf_fit {
namespace {

using test::dot;
using test::noise;

PsfProjector small_camera(const Vec3& sigma_mm, double filtered = 0) {
  CellLattice cells;
  cells.count = {14, 12, 10};
  cells.step = {2, 2.5, 3};
  cells.edge_mm = 1;
  Pixels pixels;
  pixels.count = {7, 6, 5};
  pixels.spacing = {4, 5, 6};
  return make_camera(cells, pixels, sigma_mm, filtered);
}

TEST(PsfProjector, SeesBackByItsTranspose) {
  for (const double filtered : {0.0, 0.5}) {
    const PsfProjector camera = small_camera({5, 4, 6}, filtered);
    const std::vector<float> cells = noise(camera.cells.size(), 1), pixels = noise(camera.pixels.size(), 2);
    // Sums of a thousand products of single precision.
    EXPECT_NEAR(dot(project(camera, cells), pixels), dot(cells, backproject(camera, pixels)), 1e-4);
  }
}

TEST(PsfProjector, KeepsWhatIsTheSameEverywhere) {
  // Far from the lattice's ends, where nothing is cut off, a sharp camera and a blurred one both see 1.
  for (const double sigma : {0.0, 2.5}) {
    const PsfProjector camera = small_camera(Vec3::Constant(sigma));
    const std::vector<float> image = project(camera, std::vector<float>(camera.cells.size(), 1.0F));
    const std::size_t middle = 3 + 7 * (3 + 6 * 2);
    EXPECT_NEAR(image[middle], 1, 0.01) << sigma;
  }
}

TEST(PsfProjector, DerivativesByItsWidthsAreThoseOfFiniteDifferences) {
  constexpr double step = 1e-3;
  const Vec3 sigma{5, 4, 6};
  const PsfProjector camera = small_camera(sigma);
  const std::vector<float> cells = noise(camera.cells.size(), 3);
  const auto derivatives = project_by_widths(camera, cells);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 more = sigma, less = sigma;
    more[axis] *= std::exp(step), less[axis] *= std::exp(-step);
    const std::vector<float> wider = project(small_camera(more), cells), narrower = project(small_camera(less), cells);
    const std::vector<float>& derivative = derivatives[static_cast<std::size_t>(axis)];
    for (std::size_t n = 0; n < derivative.size(); ++n)
      EXPECT_NEAR(derivative[n], (wider[n] - narrower[n]) / (2 * static_cast<float>(step)), 2e-3);  // single precision
  }
}

}  // namespace
}  // namespace dynasurf::psf_fit
