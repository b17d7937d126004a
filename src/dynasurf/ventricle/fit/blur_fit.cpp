#include "dynasurf/ventricle/fit/blur_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/ventricle/fit/detail/extracardiac_sources.hpp"
#include "dynasurf/ventricle/fit/detail/fitted_mesh.hpp"
#include "dynasurf/ventricle/fit/detail/harmonics.hpp"
#include "dynasurf/ventricle/fit/detail/reconstruction_filter.hpp"
#include "dynasurf/ventricle/locate.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double sigmas_per_fwhm = 2.3548200450309493;

// Of healthy muscle. The time's mean of what a fit leaves beside the heart is doubted from `usual_rest` on: a right
// ventricle that is left over would be explained by a wider point spread and a thinner wall.
constexpr double usual_rest = 0.004, least_spot = 0.03;
constexpr int most_spots = 70;

// Points by which EF reads too high behind filtered back projection, which leaves attenuation in the image: the mean
// over seeds 1 to 30 of experiments/camera. No part of the model explains it.
constexpr double unmodelled_ef = 3.2;

struct Blur {
  double fwhm_mm = 0, uncertainty = 0;
  double filtered = 0.5;  // share of its variance that a filter on the voxels makes
};
/// True where every voxel is either nothing or one value: a drawing of the muscle, which no camera has seen.
bool is_mask(const Study& study) {
  float full = 0;
  for (const Image& gate : study.gates)
    for (const float v : gate.values) {
      if (v == 0) continue;
      if (full == 0) full = v;
      if (v != full) return false;
    }
  return full != 0;
}

Blur blur_of(const Study& study, const BlurFit& options) {
  Blur blur{12, 0.2};
  if (study.modality == "PT") blur = {6, 0.25};
  if (study.modality == "MR" || study.modality == "CT" || is_mask(study)) blur = {0, 0};
  if (options.fwhm_mm) blur = {*options.fwhm_mm, *options.fwhm_mm > 0 ? options.fwhm_uncertainty : 0};
  if (options.filter_fwhm_mm && blur.fwhm_mm > 0)
    blur.filtered = std::min(0.9, own::pow(*options.filter_fwhm_mm / blur.fwhm_mm, 2));
  return blur;
}

struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
};

Box box_of(const std::vector<TriMesh>& meshes) {
  Box box;
  for (const TriMesh& mesh : meshes)
    for (const Vec3& p : mesh.vertices) box.low = box.low.cwiseMin(p), box.high = box.high.cwiseMax(p);
  return box;
}

Pixels pixels_around(const Box& box, const Grid& grid, double sigma_mm, double margin_mm) {
  Pixels pixels;
  pixels.spacing = grid.spacing;
  for (int a = 0; a < 3; ++a) {
    // Sharp voxels of 2 mm and less are joined: their edges are known better than a wall is smooth.
    const double wanted = sigma_mm > 0 ? std::max(1.4 * sigma_mm, 3.0) : 4.0;
    const int joined = std::max(1, static_cast<int>(std::lround(wanted / grid.spacing[a])));
    const int from = std::max(0, static_cast<int>(std::floor((box.low[a] - margin_mm) / grid.spacing[a])));
    const int to = std::min(grid.dims[a] - 1, static_cast<int>(std::ceil((box.high[a] + margin_mm) / grid.spacing[a])));
    pixels.joined[static_cast<std::size_t>(a)] = joined;
    pixels.first[static_cast<std::size_t>(a)] = from;
    pixels.count[static_cast<std::size_t>(a)] = std::max(0, (to - from + 1) / joined);
  }
  return pixels;
}

CellLattice lattice_around(const Box& box, const Pixels& pixels, double sigma_mm, double margin_mm) {
  CellLattice lattice;
  double pitch[3], finest = 1e9;
  for (int a = 0; a < 3; ++a) {
    pitch[a] = pixels.spacing[a] * pixels.joined[static_cast<std::size_t>(a)];
    finest = std::min(finest, pitch[a]);
  }
  const double wanted = std::max(0.7 * sigma_mm, std::min(0.5 * finest, 2.0));
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    // Sharp images want whole cells in every voxel, two in a joined one.
    constexpr double sharp_mm = 2.3;
    lattice.step[a] = 0.7 * sigma_mm > std::min(0.5 * finest, 2.0)
                          ? wanted
                          : pitch[a] / std::ceil(pitch[a] / (sigma_mm > 0 ? wanted : sharp_mm) - 1e-9);
    const double edge = pixels.centre(a, 0) - pitch[a] / 2;
    const double from = std::floor((box.low[a] - margin_mm - edge) / lattice.step[a]);
    const double to = std::ceil((box.high[a] + margin_mm - edge) / lattice.step[a]);
    lattice.start[a] = edge + (from + 0.5) * lattice.step[a];
    lattice.count[axis] = std::max(1, static_cast<int>(to - from));
  }
  lattice.edge_mm = 0.5 * lattice.step.maxCoeff();
  if (sigma_mm > 0) lattice.edge_mm = std::min(lattice.edge_mm, 0.5 * sigma_mm);
  return lattice;
}

/// Width (mm) of the Gaussian that lets half of the same frequency through.
double width_of(const ReconstructionFilter& filter) {
  const double half_at = filter.cutoff_per_mm * own::pow(3, 0.5 / filter.order);
  return sigmas_per_fwhm * std::sqrt(2 * own::log(2)) / (2 * M_PI * half_at);
}

/// Width (mm) of the point spread before the reconstruction's filter: of the collimator, the bins and the cut into
/// slices. Where the whole is given, it is freed of the filter's.
double width_before(const ReconstructionFilter& filter, const BlurFit& options) {
  constexpr double usual_mm = 11;
  if (!options.fwhm_mm) return usual_mm;
  const double whole = *options.fwhm_mm, of_filter = width_of(filter);
  return std::sqrt(std::max(whole * whole - of_filter * of_filter, 0.25 * whole * whole));
}

/// The filter in the noise of a study. None where it alone would be wider than all of the point spread: few counts and
/// a fast beat look like that.
std::optional<ReconstructionFilter> filter_seen(const Study& study, const Blur& blur) {
  const std::optional<ReconstructionFilter> filter = filter_in_noise(study);
  if (filter && width_of(*filter) > (1 + 2 * blur.uncertainty) * blur.fwhm_mm) return std::nullopt;
  return filter;
}

/// A study whose reconstruction left a Butterworth filter in it, with a Gaussian one in its place, and how wide the
/// point spread is then.
struct Refiltered {
  Study study;
  Blur blur;
  std::string note;
};
std::optional<Refiltered> without_lobes(const Study& study, const PlacedStart& start, const Blur& blur,
                                        const BlurFit& options) {
  if (blur.fwhm_mm <= 0) return std::nullopt;
  // PET has other widths, and the noise of finer voxels was interpolated: its steep end is no filter.
  constexpr double finest_mm = 2.4, least_per_cm = 0.05;
  std::optional<ReconstructionFilter> filter;
  if (!options.butterworth_per_cm) {
    if (study.modality != "PT" && study.grid().spacing.minCoeff() >= finest_mm) filter = filter_seen(study, blur);
  } else if (*options.butterworth_per_cm > 0) {
    if (*options.butterworth_per_cm < least_per_cm)
      throw OptionError("option fit.butterworth_per_cm is " + std::to_string(*options.butterworth_per_cm) +
                        "; expected 0 for no filter, or at least 0.05 cycles/cm");
    filter = ReconstructionFilter{*options.butterworth_per_cm / 10, options.butterworth_order};
  }
  if (!filter) return std::nullopt;
  const double sigma_mm = gaussian_in_place_of(*filter), fwhm_mm = sigmas_per_fwhm * sigma_mm;
  const Box heart = box_of(start.epi);
  VoxelBox around;
  const Grid& grid = study.grid();
  for (int a = 0; a < 3; ++a) {
    const double room = 2.5 * fwhm_mm + 10;
    const auto axis = static_cast<std::size_t>(a);
    around.first[axis] = std::max(0, static_cast<int>(std::floor((heart.low[a] - room) / grid.spacing[a])));
    const int last =
        std::min(grid.dims[axis] - 1, static_cast<int>(std::ceil((heart.high[a] + room) / grid.spacing[a])));
    around.count[axis] = std::max(1, last - around.first[axis] + 1);
  }
  Refiltered refiltered{with_gaussian_filter(study, *filter, sigma_mm, around), blur, {}};
  refiltered.blur.fwhm_mm = own::hypot(width_before(*filter, options), fwhm_mm);
  refiltered.blur.uncertainty = options.fwhm_mm ? std::max(blur.uncertainty, 0.07) : 0.15;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "%s a Butterworth filter of order %.0f, cutoff %.2f cycles/cm; it was exchanged for a Gaussian of %.1f mm",
      options.butterworth_per_cm ? "the study was reconstructed with" : "the noise shows", filter->order,
      10 * filter->cutoff_per_mm, fwhm_mm);
  refiltered.note = text;
  return refiltered;
}

/// The outermost of a wall over the beat, as harmonics of log q.
Eigen::VectorXd outermost(const PlacedStart& start, int degree) {
  Eigen::VectorXd most;
  double volume = 0;
  for (std::size_t g = 0; g < start.epi.size(); ++g) {
    const double v = mesh::volume_mm3(start.epi[g]);
    if (most.size() > 0 && v <= volume) continue;
    most = harmonics_of_surface(start.epi[g], start.frame, start.base[g], degree);
    volume = v;
  }
  return most;
}

/// Where a pixel lies against the wall at the start.
struct Place {
  double outside_mm = 0, above_mm = 0, depth = 0;  // depth: q over that of the outer wall
};

struct Setup {
  BeatProblem problem;
  std::vector<Place> place;
  double unit = 1;     // image value of activity 1
  double healthy = 1;  // of muscle in the blurred image
  double background = 0, cavity = 0;
  double highest_mm = 0;
};

/// Of the gate whose cavity is the largest at the start.
ThicknessPrior believe_in_thickness(const PlacedStart& start, int degree) {
  constexpr int directions = 120;
  ThicknessPrior belief;
  double largest = 0;
  for (std::size_t g = 0; g < start.endo.size(); ++g) {
    const double volume = mesh::volume_mm3(start.endo[g]);
    if (volume > largest) largest = volume, belief.gate = static_cast<int>(g);
  }
  const double base = start.frame.to_heart(start.base[static_cast<std::size_t>(belief.gate)].point)[2];
  std::vector<double> mm, harmonics(static_cast<std::size_t>(harmonics_up_to(degree)));
  std::vector<std::vector<double>> rows;
  for (int n = 0; n < directions; ++n) {
    const Vec3 direction = fibonacci_direction(n, directions);
    if (direction[2] * start.frame.scale[2] > 0.8 * base) continue;
    real_spherical_harmonics(direction, degree, harmonics);
    rows.push_back(harmonics);
    mm.push_back(1 / direction.cwiseQuotient(start.frame.scale).norm());
  }
  belief.harmonics.resize(static_cast<Eigen::Index>(rows.size()), harmonics_up_to(degree));
  for (std::size_t n = 0; n < rows.size(); ++n)
    belief.harmonics.row(static_cast<Eigen::Index>(n)) =
        Eigen::Map<Eigen::RowVectorXd>(rows[n].data(), harmonics_up_to(degree));
  belief.mm_per_q = Eigen::Map<Eigen::VectorXd>(mm.data(), static_cast<Eigen::Index>(mm.size()));
  return belief;
}

Setup set_up(const Study& study, const PlacedStart& start, const Blur& blur, const BlurFit& options) {
  Setup s;
  BeatProblem& p = s.problem;
  const Grid& grid = study.grid();
  p.sigma_mm = blur.fwhm_mm / sigmas_per_fwhm;
  // Where voxels are finer than the blur, it does not matter whether it came before or after them.
  p.filtered = grid.spacing.maxCoeff() > 1.2 * p.sigma_mm ? blur.filtered : 0;
  constexpr double room = 9;  // mm, for an outer wall that lies farther out than at the start
  const double margin = std::max(0.8 * blur.fwhm_mm, 1.5 * grid.spacing.maxCoeff()) + room / 2;
  const Box box = box_of(start.epi);
  p.pixels = pixels_around(box, grid, p.sigma_mm, margin);
  const CellLattice lattice = lattice_around(box, p.pixels, p.sigma_mm, room);
  constexpr int outer_degree = 4;
  const Eigen::VectorXd outer = outermost(start, outer_degree);
  for (const BasePlane& base : start.base) s.highest_mm = std::max(s.highest_mm, start.frame.to_heart(base.point)[2]);
  const int degree = std::max({options.shape_degree, options.wall_degree, options.uptake_degree});
  p.cells = select_cells(lattice, start.frame, degree, s.highest_mm + 10, outer, outer_degree, room);

  const Index3 dims = p.pixels.count;
  s.place.resize(p.pixels.size());
  parallel_for(static_cast<std::size_t>(dims[2]), 1, [&](std::size_t k, std::size_t) {
    std::vector<double> harmonics(static_cast<std::size_t>(harmonics_up_to(outer_degree)));
    Place* place = s.place.data() + k * static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]);
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i, ++place) {
        const Vec3 heart = start.frame.to_heart(
            {p.pixels.centre(0, i), p.pixels.centre(1, j), p.pixels.centre(2, static_cast<int>(k))});
        const Vec3 scaled = heart.cwiseQuotient(start.frame.scale);
        const double q = std::max(1e-6, scaled.norm());
        real_spherical_harmonics(scaled / q, outer_degree, harmonics);
        double wall = 0;
        for (int h = 0; h < harmonics_up_to(outer_degree); ++h)
          wall += outer[h] * harmonics[static_cast<std::size_t>(h)];
        place->outside_mm = (q - own::exp(wall)) / (scaled / q).cwiseQuotient(start.frame.scale).norm();
        place->above_mm = heart[2] - s.highest_mm;
        place->depth = q / own::exp(wall);
      }
  });
  std::vector<double> mean(p.pixels.size(), 0.0);
  for (const Image& gate : study.gates) {
    p.values.push_back(join(gate, p.pixels));
    for (std::size_t n = 0; n < mean.size(); ++n)
      mean[n] += static_cast<double>(p.values.back()[n]) / static_cast<double>(study.gates.size());
  }
  std::vector<double> wall, around, inside;
  for (std::size_t n = 0; n < mean.size(); ++n) {
    const Place& place = s.place[n];
    if (place.above_mm < 0 && place.outside_mm < 0 && place.depth > 0.5) wall.push_back(mean[n]);
    if (place.above_mm < 0 && place.outside_mm > 0.5 * margin && place.outside_mm < margin) around.push_back(mean[n]);
    if (place.above_mm < -5 && place.depth < 0.3) inside.push_back(mean[n]);
  }
  s.healthy = std::max(1e-12, quantile(wall, 0.9));
  s.unit = 1.1 * s.healthy;
  s.background = quantile(around, 0.25) / s.unit;
  s.cavity = quantile(inside, 0.5) / s.unit;
  for (auto& values : p.values)
    for (float& v : values) v = static_cast<float>(static_cast<double>(v) / s.unit);
  s.problem.thickness = believe_in_thickness(start, degree);
  p.weight.resize(mean.size());
  for (std::size_t n = 0; n < mean.size(); ++n) {
    const Place& place = s.place[n];
    const bool looked_at = place.outside_mm < margin && place.above_mm < margin;
    // Counts are as uncertain as they are many; the noise of sharp images, MR and CT, is the same everywhere.
    const double variance = blur.fwhm_mm > 0 ? std::max(mean[n] / s.unit, 0.1) : 1;
    p.weight[n] = looked_at ? static_cast<float>(1 / variance) : 0.0F;
  }
  return s;
}

/// Weights that trust pixels beside the heart less where the time's mean of what is left is large: there is something
/// else, or noise. Too dark ones are trusted as little as too bright ones, else noise would make the surroundings dark.
void reweight_outliers(BeatProblem& problem, const std::vector<float>& first_weight, const std::vector<Place>& places,
                       const Objective& objective) {
  for (std::size_t n = 0; n < problem.weight.size(); ++n) {
    problem.weight[n] = first_weight[n];
    if (places[n].outside_mm <= 0) continue;
    double missing = 0;
    for (const auto& residual : objective.residual)
      missing -= static_cast<double>(residual[n]) / static_cast<double>(objective.residual.size());
    problem.weight[n] /= static_cast<float>(1 + own::pow(missing / usual_rest, 2));
  }
}

/// What a fit leaves, freed of what stands still or moves with the beat: third differences over the gates, which keep
/// the variance of noise that differs from gate to gate. What is left itself where there are too few gates.
std::vector<std::vector<float>> fast_part(const std::vector<std::vector<float>>& residual) {
  const std::size_t gates = residual.size();
  if (gates < 6) return residual;
  const float scale = 1 / std::sqrt(20.0F);
  std::vector<std::vector<float>> fast = residual;
  for (std::size_t g = 0; g < gates; ++g)
    for (std::size_t n = 0; n < fast[g].size(); ++n)
      fast[g][n] = scale * (residual[(g + gates - 1) % gates][n] - 3 * residual[g][n] +
                            3 * residual[(g + 1) % gates][n] - residual[(g + 2) % gates][n]);
  return fast;
}

/// Variances of a pixel of weight 1 times the number of pixels that share their noise.
struct PixelNoise {
  double within_blur = 0;  // shared no farther than the point spread reaches
  double seen = 0;         // shared as far as what the fit leaves
};

/// The noise that the fit leaves. Filters share it, and they are a part of the point spread: what reaches farther is
/// misfit, and taken for noise it would make the priors win. It is in the errors all the same.
PixelNoise noise_of(const BeatProblem& problem, const Objective& objective) {
  const std::vector<std::vector<float>> noise = fast_part(objective.residual);
  const Index3 dims = problem.pixels.count;
  const std::size_t stride[3] = {1, static_cast<std::size_t>(dims[0]),
                                 static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1])};
  std::vector<std::vector<float>> scaled = noise;
  std::vector<double> squares;
  for (auto& values : scaled)
    for (std::size_t n = 0; n < values.size(); ++n) {
      values[n] *= std::sqrt(problem.weight[n]);
      if (problem.weight[n] > 0) squares.push_back(static_cast<double>(values[n] * values[n]));
    }
  // By the median, so that a hot neighbour does not pass for noise.
  const double variance = std::max(1e-12, quantile(squares, 0.5) / (0.6745 * 0.6745));
  const auto most = static_cast<float>(3 * std::sqrt(variance));
  for (auto& values : scaled)
    for (float& v : values) v = std::clamp(v, -most, most);
  double shared = 1, shared_within_blur = 1;
  for (int axis = 0; axis < 3; ++axis) {
    double of_axis = 1;
    for (int lag = 1; lag < 8 && lag < dims[static_cast<std::size_t>(axis)]; ++lag) {
      double product = 0, pairs = 0;
      const std::size_t apart = stride[axis] * static_cast<std::size_t>(lag);
      const auto length = static_cast<std::size_t>(dims[static_cast<std::size_t>(axis)]);
      for (const auto& values : scaled)
        for (std::size_t n = 0; n + apart < values.size(); ++n) {
          if (n / stride[axis] % length + static_cast<std::size_t>(lag) >= length) continue;
          if (problem.weight[n] <= 0 || problem.weight[n + apart] <= 0) continue;
          product += static_cast<double>(values[n] * values[n + apart]);
          pairs += 1;
        }
      const double correlation = pairs > 0 ? product / pairs / variance : 0;
      if (correlation < 0.05) break;
      of_axis += 2 * correlation;
    }
    const double pixel_mm = problem.pixels.spacing[axis] * problem.pixels.joined[static_cast<std::size_t>(axis)];
    const double within_blur = 2 * std::sqrt(M_PI) * problem.sigma_mm / pixel_mm;
    shared *= of_axis;
    shared_within_blur *= problem.sigma_mm > 0 ? std::min(of_axis, std::max(1.0, within_blur)) : of_axis;
  }
  constexpr double least = 1e-5;  // of the square of healthy muscle: no model is better than that
  // What the model leaves out stands still: no number of gates averages it away.
  constexpr double model = 0.01;  // of healthy muscle
  const double alone = std::max(variance, least) + model * model * static_cast<double>(objective.residual.size());
  return {alone * shared_within_blur, alone * shared};
}

}  // namespace

FittedBeat fit_through_blur(const Study& original, const FitStart& start, const BlurFit& requested,
                            const Progress& progress) {
  BlurFit options = requested;
  check_options(options, "fit");
  const PlacedStart placed = place_start(start, original.grid());
  const Blur as_stored = blur_of(original, options);
  const std::optional<Refiltered> refiltered = without_lobes(original, placed, as_stored, options);
  const Study& study = refiltered ? refiltered->study : original;
  const Blur blur = refiltered ? refiltered->blur : as_stored;
  // Finer harmonics than the blur lets through would only fit noise.
  const double size =
      std::sqrt(placed.frame.scale[0] * placed.frame.scale[2]) / std::max(blur.fwhm_mm / sigmas_per_fwhm, 3.0);
  options.uptake_degree = std::min(options.uptake_degree, std::max(3, static_cast<int>(std::lround(1.6 * size))));
  options.shape_degree = std::min(options.shape_degree, std::max(4, static_cast<int>(std::lround(size))));
  Setup setup = set_up(study, placed, blur, options);
  BeatProblem& problem = setup.problem;
  Priors beliefs;
  beliefs.width = blur.uncertainty;
  beliefs.stretch = 0.75 * blur.uncertainty;

  const GateLayout layout = make_gate_layout(options.shape_degree, options.wall_degree, options.uptake_degree, 0);
  if (setup.cavity > 0.6) beliefs.cavity_level = setup.cavity, beliefs.cavity = 0.3;
  Eigen::VectorXd unknowns;
  std::vector<Eigen::VectorXd> first = first_numbers(placed, layout, setup.background, beliefs.cavity_level);
  const Eigen::VectorXd uptake = uptake_seen(mean_image(study.gates), placed, setup.healthy, options.uptake_degree);
  for (Eigen::VectorXd& gate : first) gate.segment(layout.uptake, uptake.size()) = uptake;
  problem.layout = make_beat_layout(layout, first, beliefs, unknowns);
  problem.noise = 0.003;
  FittedBeat beat;
  if (refiltered) beat.notes.push_back({Severity::info, "fit.filter_exchanged", refiltered->note});
  const std::vector<float> first_weight = problem.weight;
  std::vector<bool> beside;
  for (const Place& place : setup.place)
    beside.push_back(place.outside_mm > 0.25 * blur.fwhm_mm && place.above_mm < blur.fwhm_mm);
  Solution solution;
  std::vector<ExtracardiacSource> blobs;
  solution.unknowns = unknowns;
  // Thick walls in a narrow point spread look much like thin ones in a wide one. Both begin as they are believed to be
  // and are let go step by step, so that the other numbers settle first. Of a filter in the noise the width is known
  // well enough to be free from the beginning.
  constexpr double tightest = 0.2;
  const ThicknessPrior believed = problem.thickness;
  const auto relax_priors = [&](double share) {
    problem.thickness.log_sd = share * believed.log_sd;
    for (const BeatLayout::Term& t : problem.layout.terms[0][static_cast<std::size_t>(layout.width)])
      problem.layout.spread[t.unknown] = (refiltered ? 1 : share) * beliefs.width;
    // Before the last round a matrix of every other pixel is good enough for the steps, and serves the next round too.
    const bool is_last = share >= 1;
    const bool is_kept = !is_last && solution.matrix.data.rows() == solution.unknowns.size();
    solution.every = is_last ? 1 : 2;
    solution.matrix.priors = is_kept ? prior_matrix(problem, solution.unknowns, solution.objective) : Eigen::MatrixXd();
    solution.damping = share > tightest ? 10 : 300;
  };
  relax_priors(tightest);
  minimise(problem, solution, 10, 1e-2, progress);
  // Of a sharp image nothing beside the heart spills over the wall: what is left there is doubted, not modelled.
  if (blur.fwhm_mm > 0) blobs = find_extracardiac_sources(problem, solution.objective, beside, least_spot, most_spots);
  if (!blobs.empty()) {
    for (const ExtracardiacSource& blob : blobs) problem.blobs.push_back(blob_image(problem, blob));
    const GateLayout wider = make_gate_layout(options.shape_degree, options.wall_degree, options.uptake_degree,
                                              static_cast<int>(blobs.size()));
    std::vector<Eigen::VectorXd> wider_first;
    for (const Eigen::VectorXd& numbers : first) {
      wider_first.push_back(Eigen::VectorXd::Zero(wider.count()));
      wider_first.back().head(numbers.size()) = numbers;
    }
    Eigen::VectorXd wider_unknowns;
    problem.layout = make_beat_layout(wider, wider_first, beliefs, wider_unknowns);
    wider_unknowns.head(solution.unknowns.size()) = solution.unknowns;
    solution.unknowns = wider_unknowns;
  }
  for (int round = 0; round < 2; ++round) {
    relax_priors(round == 0 ? tightest : 0.4);
    reweight_outliers(problem, first_weight, setup.place, solution.objective);
    problem.noise = noise_of(problem, solution.objective).within_blur;
    minimise(problem, solution, 8, 1e-2, progress);
  }
  reweight_outliers(problem, first_weight, setup.place, solution.objective);
  const PixelNoise noise = noise_of(problem, solution.objective);
  problem.noise = noise.within_blur;
  relax_priors(1);
  minimise(problem, solution, std::max(1, options.most_steps - solution.steps), 1e-3, progress);
  beat.steps = solution.steps;
  beat.objective = solution.objective.value;
  beat.extracardiac_sources = static_cast<int>(blobs.size());
  beat.converged = solution.converged;
  // Sharp images show papillary muscles as they are.
  describe_beat(problem, solution, noise.seen, study.grid(), blur.fwhm_mm > 0 ? options.papillary_share : 0, beat);
  beat.fwhm_mm.value = blur.fwhm_mm * own::exp(problem.layout.at_gate(0, solution.unknowns)[layout.width]);
  if (refiltered && beat.ef_percent) beat.ef_percent->sd = own::hypot(beat.ef_percent->sd, unmodelled_ef);
  // Of its log until here. Cameras differ from one Gaussian: so widened, the interval holds the truth in 90 % of the
  // choosing patients of experiments/unbiased_200.
  if (beat.fwhm_mm.sd > 0) beat.fwhm_mm.sd = beat.fwhm_mm.value * own::hypot(2 * beat.fwhm_mm.sd, 0.015);
  return beat;
}

}  // namespace dynasurf::ventricle
