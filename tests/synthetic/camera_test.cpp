#include "dynasurf/synthetic/camera.hpp"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/synthetic/detail/random.hpp"
#include "dynasurf/synthetic/detail/render.hpp"

namespace dynasurf::synthetic {
namespace {

Grid cube(int n, double voxel_mm) {
  Grid grid;
  grid.dims = {n, n, n};
  grid.spacing = Vec3::Constant(voxel_mm);
  grid.origin = -0.5 * (n - 1) * grid.spacing;
  return grid;
}

Image filled(const Grid& grid, const auto& value_at) {
  Image image(grid);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i)
        image(i, j, k) = static_cast<float>(value_at(to_world(grid, centre_of(grid, {i, j, k}))));
  return image;
}

/// A ball or a long cylinder along the patient, with partial voxels at its border.
double part_inside(double distance, double radius, double voxel_mm) {
  return std::clamp((radius - distance) / voxel_mm + 0.5, 0.0, 1.0);
}
Image ball(const Grid& grid, const Vec3& middle, double radius, double value) {
  return filled(grid, [&](const Vec3& p) { return value * part_inside((p - middle).norm(), radius, grid.spacing[0]); });
}
Image cylinder(const Grid& grid, double radius, double value) {
  return filled(grid,
                [&](const Vec3& p) { return value * part_inside(std::hypot(p[0], p[1]), radius, grid.spacing[0]); });
}

/// A source small against the blur, known to a hair: a Gaussian of 1.5 voxels.
Image spot(const Grid& grid, const Vec3& middle) {
  const double sigma = 1.5 * grid.spacing[0];
  return filled(grid, [&](const Vec3& p) { return std::exp(-(p - middle).squaredNorm() / (2 * sigma * sigma)); });
}

double total_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0,
                         [](double a, float b) { return a + static_cast<double>(b); });
}

struct Moments {
  double sum = 0, across = 0, along = 0;  // total, variances in mm²
};
Moments moments_of(const std::vector<float>& bins, int n, double bin_mm) {
  double sum = 0, m[2] = {}, s[2] = {};
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < n; ++c) {
      const auto v = static_cast<double>(bins[static_cast<std::size_t>(k) * n + c]);
      const double x[2] = {c * bin_mm, k * bin_mm};
      sum += v;
      for (int a = 0; a < 2; ++a) m[a] += v * x[a], s[a] += v * x[a] * x[a];
    }
  return {sum, s[0] / sum - m[0] * m[0] / (sum * sum), s[1] / sum - m[1] * m[1] / (sum * sum)};
}

TEST(Collimator, HasTheWidthAndSensitivityOfItsFormula) {
  const Collimator lehr = collimator_of({});
  // By hand: le = 24.05 - 0.74 = 23.31; 1.11 (23.31 + 100) / 23.31 = 5.8719; with 3.8: 6.9943.
  EXPECT_NEAR(fwhm_at(response_of(lehr), 100), 6.9943, 1e-3);
  EXPECT_NEAR(fwhm_at(response_of(lehr), 0), std::hypot(1.11, 3.8), 1e-12);
  // Data sheets of such collimators say 202 and 330 counts per minute and microcurie.
  EXPECT_NEAR(sensitivity_cps_per_mbq(lehr), 202 / 60.0 / 0.037, 0.05 * 91);
  Acquisition legp;
  legp.collimator = CollimatorModel::legp;
  EXPECT_NEAR(sensitivity_cps_per_mbq(collimator_of(legp)), 330 / 60.0 / 0.037, 0.05 * 149);
}

TEST(Project, GivesASpotTheSameCountsAtAnyDistanceAndTheWidthOfTheFormula) {
  const Grid grid = cube(64, 3.2);
  const CameraResponse response = response_of(collimator_of({}));
  for (const double towards_left : {-60.0, 0.3, 45.0})
    for (const double angle : {0.0, 33.0, 90.0}) {
      const Vec3 middle{towards_left, 7.1, -5.2};
      const Image source = spot(grid, middle);
      const Projections p = project({source}, nullptr, &response, {angle}, {150});
      const Moments seen = moments_of(p.gates[0], 64, 3.2);
      const double a = angle * M_PI / 180, towards = middle[0] * std::sin(a) - middle[1] * std::cos(a);
      const double variance = std::pow(sigma_of_fwhm(fwhm_at(response, 150 - towards)), 2) + std::pow(1.5 * 3.2, 2);
      EXPECT_NEAR(seen.sum / total_of(source.values), 1, 1e-3) << angle;
      EXPECT_NEAR(seen.along / variance, 1, 0.005) << "angle " << angle << " at " << towards;
      // What interpolation on the rotated lattice widens is allowed for.
      EXPECT_NEAR(seen.across / variance, 1, 0.005) << "angle " << angle << " at " << towards;
    }
}

TEST(Project, PlacesAPointWhereTheCameraSeesIt) {
  const Grid grid = cube(64, 3.2);
  const Image source = spot(grid, {40, 20, -30});
  const auto middle_of = [&](double angle) {
    const Projections p = project({source}, nullptr, nullptr, {angle}, {200});
    double sum = 0, x = 0, z = 0;
    for (int k = 0; k < 64; ++k)
      for (int c = 0; c < 64; ++c) {
        const auto v = static_cast<double>(p.gates[0][static_cast<std::size_t>(k) * 64 + c]);
        sum += v, x += v * (c - 31.5) * 3.2, z += v * (k - 31.5) * 3.2;
      }
    return std::pair{x / sum, z / sum};
  };
  EXPECT_NEAR(middle_of(0).first, 40, 0.1) << "from the front, the patient's left is at the right";
  EXPECT_NEAR(middle_of(90).first, 20, 0.1) << "from his left, his back is at the right";
  EXPECT_NEAR(middle_of(180).first, -40, 0.1);
  EXPECT_NEAR(middle_of(90).second, -30, 0.1);
}

TEST(Project, AttenuatesASlabByItsFormula) {
  constexpr double mu = 0.015, voxel = 4;  // 1/mm
  const Grid grid = cube(48, voxel);
  const auto in_slab = [](const Vec3& p) { return p[1] > -40 && p[1] < 60; };  // 25 planes: 100 mm
  const Image slab = filled(grid, [&](const Vec3& p) { return in_slab(p) ? 1 : 0; });
  const Image map = filled(grid, [&](const Vec3& p) { return in_slab(p) ? mu : 0; });
  for (const double angle : {0.0, 180.0}) {
    const Projections p = project({slab}, &map, nullptr, {angle}, {200});
    const double seen = static_cast<double>(p.gates[0][24 * 48 + 24]);
    EXPECT_NEAR(seen * voxel, (1 - std::exp(-mu * 100)) / mu, 1e-4 * 52) << "the mean over an even slab is exact";
  }
  // A plane in the air behind the slab loses exp(-mu D).
  const Image behind = filled(grid, [&](const Vec3& p) { return p[1] > 80 && p[1] < 84 ? 1 : 0; });
  const Projections p = project({behind}, &map, nullptr, {0, 180}, {200, 200});
  EXPECT_NEAR(static_cast<double>(p.gates[0][24 * 48 + 24]), std::exp(-mu * 100), 1e-5);
  EXPECT_NEAR(static_cast<double>(p.gates[0][p.bins() + 24 * 48 + 24]), 1, 1e-5);
}

TEST(BackProject, IsTheAdjointOfProject) {
  const Grid grid = cube(32, 6.4);
  const auto random_image = [&](std::uint64_t stream) {
    Image image(grid);
    for (std::size_t v = 0; v < image.values.size(); ++v)
      image.values[v] = static_cast<float>(Random(3, stream, v).uniform());
    return image;
  };
  const Image activity = random_image(1), map = [&] {
    Image image = random_image(2);
    for (float& v : image.values) v *= 0.02F;
    return image;
  }();
  const CameraResponse response = response_of(collimator_of({}));
  const auto dot = [](const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t v = 0; v < a.size(); ++v) sum += static_cast<double>(a[v]) * static_cast<double>(b[v]);
    return sum;
  };
  for (const Image* attenuation : {static_cast<const Image*>(nullptr), &map})
    for (const CameraResponse* blur : {static_cast<const CameraResponse*>(nullptr), &response}) {
      Projections seen = project({activity}, attenuation, blur, {-45, 0, 17.3, 90, 140}, {120, 130, 140, 150, 160});
      Projections other = seen;
      for (std::size_t v = 0; v < other.gates[0].size(); ++v)
        other.gates[0][v] = static_cast<float>(Random(3, 5, v).uniform());
      const double forward = dot(seen.gates[0], other.gates[0]);
      const double backward = dot(activity.values, back_project(other, attenuation, blur)[0].values);
      EXPECT_NEAR(backward / forward, 1, 1e-6);
    }
}

/// A cylinder of 80 mm in the air or in itself, seen by a small camera.
struct Bench {
  Acquisition options;
  Grid grid;
  Image activity, attenuation;
  std::vector<double> radius;
  Projections counts(std::uint64_t seed = 1) const {
    return acquire({activity, activity}, attenuation, radius, options, seed);
  }
};
Bench bench(bool is_attenuated) {
  Bench b;
  b.options.size = 32;
  b.options.million_counts = 3;
  b.options.attenuation = is_attenuated;
  b.grid = activity_grid(b.options, {0, 0, 0});
  b.activity = cylinder(b.grid, 80, 1);
  b.attenuation = cylinder(b.grid, 80, 0.015);
  b.radius.assign(64, 150);
  return b;
}

TEST(Acquire, CountsAreOfPoissonAroundTheirMeans) {
  Bench b = bench(false);
  const Projections drawn = b.counts();
  b.options.is_noisy = false;
  const Projections mean = b.counts();
  EXPECT_NEAR(total_of(mean.gates[0]) + total_of(mean.gates[1]), 3e6, 3);
  double chi = 0, n = 0;
  for (std::size_t v = 0; v < mean.gates[0].size(); ++v) {
    const auto m = static_cast<double>(mean.gates[0][v]), d = static_cast<double>(drawn.gates[0][v]);
    EXPECT_EQ(d, std::floor(d));
    if (m > 5) chi += (d - m) * (d - m) / m, ++n;
  }
  EXPECT_NEAR(chi / n, 1, 5 * std::sqrt(2 / n)) << "five standard deviations";
  EXPECT_NE(drawn.gates[0], drawn.gates[1]);
}

TEST(Acquire, RejectedBeatsTakeTheirPartOfTheCounts) {
  Bench b = bench(false);
  b.options.is_noisy = false, b.options.rejected_percent = 20;
  const Projections p = b.counts();
  // A mean of 64 even deviates between 0 and 0.4 is known to 0.115 / 8.
  EXPECT_NEAR((total_of(p.gates[0]) + total_of(p.gates[1])) / 3e6, 0.8, 0.045);
}

TEST(Acquire, ScatterAddsWhatItIsToldAndTheSideWindowsTellIt) {
  Bench b = bench(true);
  b.options.is_noisy = false;
  const auto ratio = [&](double scatter) {
    b.options.scatter = scatter;
    const Projections p = b.counts();
    return total_of(p.scatter[0]) / (total_of(p.gates[0]) - total_of(p.scatter[0]));
  };
  const double one = ratio(0.3);
  // Half of the photons have crossed less than half an attenuation length, and some scatter falls beside the camera.
  EXPECT_GT(one, 0.05);
  EXPECT_LT(one, 0.3);
  EXPECT_NEAR(ratio(0.6) / one, 2, 0.05) << "the filter of the side windows loses some at the camera's rim";
  b.options.scatter = 0;
  EXPECT_TRUE(b.counts().scatter.empty());
}

TEST(Acquire, BreathingSpreadsAndMovingShiftsWhatIsSeen) {
  Bench b = bench(false);
  b.activity = spot(b.grid, {0, 0, 0});
  b.options.is_noisy = false;
  const auto variance = [&] {
    const Projections p = b.counts();
    return moments_of({p.gates[0].begin(), p.gates[0].begin() + 1024}, 32, 6.4).along;
  };
  const double still = variance();
  b.options.breathing_mm = 20;
  // cos⁴ of a whole turn has the variance 35/128 - 9/64; linear interpolation adds up to a quarter of a fine voxel.
  EXPECT_NEAR(variance() - still, 400 * (35.0 / 128 - 9.0 / 64), 0.25 * 3.2 * 3.2);
  b.options.breathing_mm = 0, b.options.move_z_mm = 12.8;
  const Projections moved = b.counts();
  // The patient moves after half the views, by two rows.
  const std::size_t last = 63 * moved.bins(), two_rows = 64;
  b.options.move_z_mm = 0;
  const Projections rest = b.counts();
  for (std::size_t v = 0; v + two_rows < moved.bins(); ++v) {
    ASSERT_EQ(moved.gates[0][v], rest.gates[0][v]);
    ASSERT_NEAR(moved.gates[0][last + v + two_rows], rest.gates[0][last + v], 0.01) << v;
  }
}

TEST(ReconstructViews, FilteredBackprojectionHasTheNoiseOfItsFormula) {
  Bench b = bench(false);
  const Projections drawn = b.counts();
  b.options.is_noisy = false;
  const Projections mean = b.counts();
  const Fbp hann{.window = Window::hann, .cutoff_per_cm = 0.6};
  const Image noisy = reconstruct_views(drawn, nullptr, hann)[0], clean = reconstruct_views(mean, nullptr, hann)[0];
  double variance = 0, n = 0;
  for (int k = 4; k < 28; ++k)
    for (int j = 12; j < 20; ++j)
      for (int i = 12; i < 20; ++i) {
        const double d = static_cast<double>(noisy(i, j, k)) - static_cast<double>(clean(i, j, k));
        variance += d * d, ++n;
      }
  variance /= n;
  // (pi / views)² × views × mean counts of a bin × the filter's power, of which linear interpolation between bins
  // leaves 2/3 + cos(w) / 3 on average.
  double power = 0;
  constexpr int steps = 256;
  for (int k = -steps / 2; k < steps / 2; ++k)
    for (int l = -steps / 2; l < steps / 2; ++l) {
      const double u = static_cast<double>(k) / steps, f = std::hypot(u, static_cast<double>(l) / steps) / 0.64;
      const double window = f < 0.6 ? 0.5 * (1 + std::cos(M_PI * f / 0.6)) : 0;
      power += u * u * window * window * (2.0 / 3 + std::cos(2 * M_PI * u) / 3) / (steps * steps);
    }
  const double bin = static_cast<double>(mean.gates[0][16 * 32 + 16]);
  // The chord shortens by 3 % over the 8 voxels; 1,500 voxels of which some four go together: 5 %.
  EXPECT_NEAR(variance / (M_PI * M_PI / 64 * bin * power), 1, 0.15);
}

/// Activity of a ball of 35 mm beside the middle: the sum within 60 mm and the mean near its middle, over the truth.
struct Recovery {
  double sum = 0, middle = 0;
};
Recovery recover(const Reconstruction& options, bool is_attenuated, double arc_deg) {
  Bench b = bench(is_attenuated);
  const Vec3 middle{16, -10, 5};
  b.activity = ball(b.grid, middle, 35, 1);
  b.options.is_noisy = false, b.options.arc_deg = arc_deg, b.options.scatter = 0;
  const std::vector<double> angles = angles_of(b.options);
  const CameraResponse response = response_of(collimator_of(b.options));
  const Grid coarse = cube(32, 6.4);
  const Image truth = ball(coarse, middle, 35, 1), map = cylinder(coarse, 80, 0.015);
  Projections p = project({truth}, is_attenuated ? &map : nullptr, &response, angles, b.radius);
  const Image image = reconstruct_views(p, &map, options)[0];
  Recovery r;
  double n = 0;
  for (int k = 0; k < 32; ++k)
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i) {
        const double away = (to_world(coarse, centre_of(coarse, {i, j, k})) - middle).norm();
        const auto value = static_cast<double>(image(i, j, k));
        if (away < 60) r.sum += value;
        if (away < 13) r.middle += value, ++n;
      }
  r.middle /= n;
  r.sum /= total_of(truth.values);
  return r;
}

TEST(ReconstructViews, GivesABallItsVolumeAndActivityBack) {
  // Ringing behind sharp windows and unfinished iterations are what the bounds allow.
  for (const double arc : {180.0, 360.0}) {
    const Recovery hann = recover(Fbp{.window = Window::hann, .cutoff_per_cm = 0.78}, false, arc);
    EXPECT_NEAR(hann.sum, 1, 0.03) << arc;
    EXPECT_NEAR(hann.middle, 1, 0.05) << arc;
    const Recovery butterworth = recover(Fbp{}, false, arc);
    EXPECT_NEAR(butterworth.sum, 1, 0.03) << arc;
    EXPECT_NEAR(butterworth.middle, 1, 0.08) << arc;
    const Recovery osem = recover(Osem{.iterations = 6, .filter_fwhm_mm = 0}, false, arc);
    EXPECT_NEAR(osem.sum, 1, 0.03) << arc;
    EXPECT_NEAR(osem.middle, 1, 0.06) << arc;
    const Recovery corrected =
        recover(Osem{.iterations = 10, .attenuation = true, .resolution = true, .filter_fwhm_mm = 0}, true, arc);
    EXPECT_NEAR(corrected.sum, 1, 0.03) << arc;
    EXPECT_NEAR(corrected.middle, 1, 0.08) << arc;
  }
  EXPECT_LT(recover(Osem{.iterations = 6}, true, 180).middle, 0.6) << "without correction attenuation is seen";
}

TEST(ReconstructViews, MoreIterationsFitTheCountsBetter) {
  const Bench b = bench(true);
  const Projections p = b.counts();
  const Image map = cut_out(b.attenuation, transaxial_grid(p));
  double before = std::numeric_limits<double>::infinity();
  for (const int iterations : {1, 3, 9}) {
    const Osem mlem{.iterations = iterations, .subsets = 1, .attenuation = true, .scatter = true, .filter_fwhm_mm = 0};
    const Image image = reconstruct_views(p, &map, mlem)[0];
    const Projections again = project({image}, &map, nullptr, p.angle_deg, p.radius_mm);
    double minus_log_likelihood = 0;
    for (std::size_t v = 0; v < p.gates[0].size(); ++v) {
      const auto mean = static_cast<double>(again.gates[0][v] + p.scatter[0][v]);
      if (mean > 0) minus_log_likelihood += mean - static_cast<double>(p.gates[0][v]) * std::log(mean);
    }
    EXPECT_LT(minus_log_likelihood, before);
    before = minus_log_likelihood;
  }
}

TEST(Camera, GivesTheSameBytesForAnyNumberOfThreads) {
  const Bench b = bench(true);
  const Osem osem{.iterations = 1, .attenuation = true, .scatter = true, .resolution = true};
  const auto make = [&](int threads) {
    const ThreadLimit limit(threads);
    const Projections p = b.counts(4);
    const Image map = cut_out(b.attenuation, transaxial_grid(p));
    return std::tuple{p.gates, p.scatter, reconstruct_views(p, &map, osem)[1].values,
                      reconstruct_views(p, nullptr, Fbp{})[0].values};
  };
  EXPECT_EQ(make(1), make(2));
}

TEST(Camera, RefusesWhatDoesNotFit) {
  const Bench b = bench(true);
  Acquisition other = b.options;
  other.bin_mm = -1;
  EXPECT_THROW(acquire({b.activity}, b.attenuation, b.radius, other, 1), OptionError);
  EXPECT_THROW(acquire({b.activity}, b.attenuation, {100}, b.options, 1), InputError);
  EXPECT_THROW(acquire({}, b.attenuation, b.radius, b.options, 1), InputError);
  EXPECT_THROW(project({Image(cube(8, 1))}, &b.attenuation, nullptr, {0}, {100}), InputError);
  const Projections p = b.counts();
  EXPECT_THROW(reconstruct_views(p, nullptr, Osem{.subsets = 7}), OptionError);
  EXPECT_THROW(require_even_subsets(Osem{.subsets = 8}, 33), OptionError);
  EXPECT_THROW(reconstruct_views(p, nullptr, Osem{.attenuation = true}), InputError);
  EXPECT_THROW(reconstruct_views(p, &b.attenuation, Osem{}), InputError) << "the fine grid is not that of the slices";
}

TEST(CutOut, InterpolatesAPlaneExactlyAndIsZeroOutside) {
  const Grid from = cube(16, 2);
  const Image plane = filled(from, [](const Vec3& p) { return 3 + 0.5 * p[0] - 0.25 * p[1] + p[2]; });
  Grid to = cube(5, 1.7);
  to.direction = Eigen::AngleAxisd(0.4, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Image image = cut_out(plane, to);
  for (int i = 0; i < 5; ++i) {
    const Vec3 p = to_world(to, centre_of(to, {i, 2, 4}));
    EXPECT_NEAR(image(i, 2, 4), 3 + 0.5 * p[0] - 0.25 * p[1] + p[2], 1e-5);
  }
  EXPECT_EQ(cut_out(plane, cube(40, 3))(0, 0, 0), 0.0F);
}

}  // namespace
}  // namespace dynasurf::synthetic
