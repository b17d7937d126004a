#include "dynasurf/ventricle/measures/detail/regional_errors.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynasurf/psf_fit/detail/harmonics.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::ventricle {

using namespace psf_fit;

namespace {

/// Four gates of a wall that is neither round nor even.
struct Beat {
  BeatProblem problem;
  Eigen::VectorXd unknowns;
};
Beat uneven_beat() {
  Beat beat;
  HeartFrame& frame = beat.problem.cells.frame;
  frame.centre = {3, -2, 5}, frame.scale = {25, 27, 33};
  const GateLayout layout = make_gate_layout(3, 2, 2, 0);
  Eigen::VectorXd gate = Eigen::VectorXd::Zero(layout.count());
  gate[layout.endo] = std::log(0.8), gate[layout.endo + 3] = 0.05, gate[layout.endo + 6] = -0.04;
  gate[layout.wall] = std::log(0.6), gate[layout.wall + 2] = 0.1;
  gate[layout.uptake + 1] = 0.2;
  beat.problem.layout = make_beat_layout(layout, {gate, gate, gate, gate}, Priors{}, beat.unknowns);
  return beat;
}

struct Ray {
  double endo_mm, epi_mm, uptake;
};
Ray ray_at(const Beat& beat, const Eigen::VectorXd& unknowns, int g, const Vec3& direction) {
  const GateLayout& layout = beat.problem.layout.gate;
  const Eigen::VectorXd gate = beat.problem.layout.at_gate(g, unknowns);
  std::vector<double> h(static_cast<std::size_t>(harmonics_up_to(3)));
  real_spherical_harmonics(direction, 3, h);
  const auto field = [&](int first, int degree) {
    double sum = 0;
    for (int k = 0; k < harmonics_up_to(degree); ++k) sum += gate[first + k] * h[static_cast<std::size_t>(k)];
    return sum;
  };
  const double mm = direction.cwiseProduct(beat.problem.cells.frame.scale).norm();
  const double q = std::exp(field(layout.endo, 3));
  return {mm * q, mm * std::cbrt(q * q * q + std::exp(field(layout.wall, 2))), std::exp(field(layout.uptake, 2))};
}

TEST(WallPosterior, KnowsHowNumbersOfTheWallsDependOnTheUnknowns) {
  const Beat beat = uneven_beat();
  constexpr int directions = 12, gate = 1;
  // Twice the thickness of some places, the size of others, and the uptake, of one gate.
  const auto number = [&](const Eigen::VectorXd& unknowns) {
    double sum = 0;
    for (int n = 0; n < directions; ++n) {
      const Ray ray = ray_at(beat, unknowns, gate, fibonacci_direction(n, directions));
      sum += n % 2 ? 2 * (ray.epi_mm - ray.endo_mm) : ray.endo_mm;
      sum += 3 * std::log(ray.uptake);
    }
    return sum;
  };
  double squares = 0;
  for (Eigen::Index k = 0; k < beat.unknowns.size(); ++k) {
    constexpr double step = 1e-5;
    Eigen::VectorXd more = beat.unknowns, less = beat.unknowns;
    more[k] += step, less[k] -= step;
    squares += std::pow((number(more) - number(less)) / (2 * step), 2);
  }

  Grid grid;
  grid.spacing = {1, 1, 1};
  psf_fit::WallPoints points;
  psf_fit::WallDependence by{Eigen::MatrixXd(directions, 1), Eigen::MatrixXd(directions, 1),
                             Eigen::MatrixXd::Constant(directions, 1, 3.0)};
  for (int n = 0; n < directions; ++n) {
    const Vec3 direction = fibonacci_direction(n, directions);
    const Ray ray = ray_at(beat, beat.unknowns, gate, direction);
    const HeartFrame& frame = beat.problem.cells.frame;
    const Vec3 unit = direction.cwiseProduct(frame.scale).normalized();
    points.endo.emplace_back(to_world(grid, frame.from_heart(ray.endo_mm * unit)));
    points.epi.emplace_back(to_world(grid, frame.from_heart(ray.epi_mm * unit)));
    by.by_endo(n, 0) = n % 2 ? -2 : 1, by.by_epi(n, 0) = n % 2 ? 2 : 0;
  }
  // With unknowns that are known to 1 and do not depend on each other, the deviation is the gradient's length.
  const auto count = beat.unknowns.size();
  const psf_fit::WallPosterior posterior(beat.problem, beat.unknowns, grid,
                                         psf_fit::Cholesky(psf_fit::RowMatrix::Identity(count, count)));
  Eigen::MatrixXd gradient = posterior.no_gradient(1);
  posterior.add(gate, points, by, gradient);
  EXPECT_NEAR(posterior.sd(gradient)[0] / std::sqrt(squares), 1, 1e-7);  // central differences
}

Result fit_patient(double peak_counts) {
  synthetic::VirtualPatient o;
  o.edv_ml = 90, o.ef_percent = 50, o.wall_ml = 100;
  o.gates = 4;
  o.lattice = {28, 28, 24, 4.8, 4.8, 4.8};
  o.noise = {peak_counts, 6, 0, 3};
  Options options = preset("psf_corrected");
  options.fit.fwhm_mm = 12;
  return reconstruct(synthetic::make_phantom(o).study, options);
}

TEST(RegionalErrors, AreWithEverySegmentOfAFitAndGrowWithTheNoise) {
  const Result calm = fit_patient(400), noisy = fit_patient(25);
  ASSERT_TRUE(calm.measures && noisy.measures);
  EXPECT_EQ(calm.measures->perfusion_is, Perfusion::uptake);
  int number = 0;
  for (const auto member :
       {&SegmentErrors::perfusion_percent, &SegmentErrors::thickness_ed_mm, &SegmentErrors::thickness_es_mm,
        &SegmentErrors::thickening_percent, &SegmentErrors::motion_mm, &SegmentErrors::area_strain_percent}) {
    SCOPED_TRACE(++number);
    double less = 0, more = 0;
    for (std::size_t s = 0; s < 17; ++s) {
      const SegmentErrors &few = calm.measures->segments[s].sd, &many = noisy.measures->segments[s].sd;
      ASSERT_TRUE(few.*member && many.*member) << s + 1;
      less += (few.*member).value(), more += (many.*member).value();
    }
    // Each has a part that stays the same, however many counts there are.
    EXPECT_GT(more, 1.1 * less);
  }
  EXPECT_TRUE(calm.measures->phase_motion.value().sd_error_deg);
  // A healthy wall of 9 mm at 12 mm is told by the data.
  EXPECT_GT(calm.readings.psf_corrected.value().thickness_from_data, 0.8);
}

TEST(RegionalErrors, SayThatAThinWallIsNotTold) {
  synthetic::VirtualPatient o;
  o.edv_ml = 220, o.ef_percent = 25, o.wall_ml = 80;
  o.gates = 4, o.fwhm_mm = 15;
  o.lattice = {28, 28, 24, 6, 6, 6};
  Options options = preset("psf_corrected");
  options.fit.fwhm_mm = 15;
  const auto says = [](const Result& result, Severity severity) {
    return std::any_of(result.notes.begin(), result.notes.end(), [severity](const Note& note) {
      return note.code == "fit.thin_wall" && note.severity == severity;
    });
  };
  EXPECT_TRUE(says(reconstruct(synthetic::make_phantom(o).study, options), Severity::warning));
  o.edv_ml = 110, o.ef_percent = 60, o.wall_ml = 120;  // 8.7 mm
  EXPECT_TRUE(says(reconstruct(synthetic::make_phantom(o).study, options), Severity::info));
  const Result healthy = fit_patient(400);  // 9 mm at 12 mm
  EXPECT_FALSE(says(healthy, Severity::warning) || says(healthy, Severity::info));
}

TEST(Presets, OfMrReadSharpImagesRight) {
  synthetic::VirtualPatient o;
  o.edv_ml = 90, o.ef_percent = 50, o.wall_ml = 100;
  o.gates = 4, o.fwhm_mm = 0, o.noise = {};
  o.lattice = {40, 40, 36, 3.2, 3.2, 3.2};
  const synthetic::Phantom phantom = synthetic::make_phantom(o);
  const Result result = reconstruct(phantom.study, preset("mr"));
  ASSERT_TRUE(result.readings.psf_corrected);
  // Measured +0.4 and +0.7 %; papillary muscles, which this heart has not, may count as 1 mL of cavity.
  EXPECT_NEAR(result.readings.psf_corrected->edv_ml.value / *phantom.edv_ml, 1, 0.03);
  EXPECT_NEAR(result.readings.psf_corrected->esv_ml.value / *phantom.esv_ml, 1, 0.05);
  // There is no Gaussian across a sharp wall: no volume is better than a wild one.
  if (result.readings.gaussian_profile) {
    for (std::size_t g = 0; g < 4; ++g)
      EXPECT_LT(result.readings.gaussian_profile->wall_ml[g], 3 * result.gates[g].edge_surfaces.epi->volume_ml) << g;
  }
}

TEST(Presets, FitThroughTheBlurUnlessEdgesAreAskedFor) {
  EXPECT_TRUE(Options{}.fit.run);
  for (const std::string_view name : preset_names()) {
    const bool reads_edges = name == "edges" || name == "thesis";
    EXPECT_EQ(preset(name).fit.run, !reads_edges) << name;
  }
}

TEST(Fit, TakesADrawingOfTheMuscleAsSharp) {
  synthetic::VirtualPatient o;
  o.edv_ml = 90, o.ef_percent = 50, o.wall_ml = 100;
  o.gates = 1, o.fwhm_mm = 0, o.noise = {}, o.cavity = 0, o.background = 0;
  o.lattice = {40, 40, 36, 3.2, 3.2, 3.2};
  synthetic::Phantom phantom = synthetic::make_phantom(o);
  std::vector<float>& values = phantom.study.gates[0].values;
  const float half = *std::max_element(values.begin(), values.end()) / 2;
  for (float& v : values) v = v > half ? 1.0F : 0.0F;
  const Result drawn = reconstruct(phantom.study, {});
  ASSERT_TRUE(drawn.readings.psf_corrected);
  EXPECT_EQ(drawn.readings.psf_corrected->fwhm_mm.value, 0);
  double drawn_ml = 0;
  for (const float v : values) drawn_ml += 3.2 * 3.2 * 3.2 / 1000 * static_cast<double>(v);
  // Measured -1.1 %.
  EXPECT_NEAR(drawn.readings.psf_corrected->wall_ml.value / drawn_ml, 1, 0.05);
  EXPECT_FALSE(drawn.readings.psf_corrected->ef_percent);
  values[0] = 0.5F;  // a grey voxel: an image, which a camera may have seen
  const Result grey = reconstruct(phantom.study, {});
  ASSERT_TRUE(grey.readings.psf_corrected);
  EXPECT_GT(grey.readings.psf_corrected->fwhm_mm.value, 0);
}

TEST(RegionalErrors, AreNotThereForEdges) {
  synthetic::VirtualPatient o;
  o.gates = 4;
  o.lattice = {28, 28, 24, 4.8, 4.8, 4.8};
  const Result edges = reconstruct(synthetic::make_phantom(o).study, preset("edges"));
  ASSERT_TRUE(edges.measures);
  EXPECT_FALSE(edges.measures->segments[0].sd.thickness_ed_mm);
  EXPECT_EQ(edges.measures->perfusion_is, Perfusion::counts);
}

}  // namespace
}  // namespace dynasurf::ventricle
