#include "dynasurf/psf_fit/blur_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/heart/locate.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/psf_fit/detail/attenuation.hpp"
#include "dynasurf/psf_fit/detail/camera_errors.hpp"
#include "dynasurf/psf_fit/detail/extracardiac_sources.hpp"
#include "dynasurf/psf_fit/detail/fitted_mesh.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"
#include "dynasurf/psf_fit/detail/pixel_noise.hpp"
#include "dynasurf/psf_fit/detail/reconstruction_filter.hpp"
#include "dynasurf/psf_fit/detail/setup.hpp"
#include "dynasurf/psf_fit/detail/wall_terms.hpp"

namespace dynasurf::psf_fit {
namespace {

// Of healthy muscle. The time's mean of what a fit leaves beside the heart is doubted from `usual_rest` on: a right
// ventricle that is left over would be explained by a wider point spread and a thinner wall.
constexpr double usual_rest = 0.004, least_spot = 0.03;
constexpr int most_spots = 70;

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
  Blur blur{12, 0.3};
  if (study.modality == "PT") blur = {6, 0.25};
  if (study.modality == "MR" || study.modality == "CT" || is_mask(study)) blur = {0, 0};
  if (options.fwhm_mm) blur = {*options.fwhm_mm, *options.fwhm_mm > 0 ? options.fwhm_uncertainty : 0};
  if (options.filter_fwhm_mm && blur.fwhm_mm > 0)
    blur.filtered = std::min(0.9, own::pow(*options.filter_fwhm_mm / blur.fwhm_mm, 2));
  return blur;
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
  const Bounds heart = bounds_of(start.epi);
  VoxelBox around;
  const Grid& grid = study.grid();
  for (int a = 0; a < 3; ++a) {
    const double room = 2.5 * fwhm_mm + 10;
    around.first[a] = std::max(0, floor_int((heart.low[a] - room) / grid.spacing[a]));
    const int last = std::min(grid.dims[a] - 1, ceil_int((heart.high[a] + room) / grid.spacing[a]));
    around.count[a] = std::max(1, last - around.first[a] + 1);
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

/// Weights that trust pixels beside the heart less where the time's mean of what is left is large: there is something
/// else, or noise. Too dark ones are trusted as little as too bright ones, else noise would make the surroundings dark.
void reweight_outliers(BeatProblem& problem, const std::vector<float>& first_weight, const std::vector<Place>& places,
                       const Objective& objective) {
  const double gates = objective.residual.size();
  for (std::size_t n = 0; n < problem.weight.size(); ++n) {
    problem.weight[n] = first_weight[n];
    if (places[n].outside_mm <= 0) continue;
    double missing = 0;
    for (const auto& residual : objective.residual) missing -= residual[n] / gates;
    const float doubt = 1 + own::pow(missing / usual_rest, 2);
    problem.weight[n] /= doubt;
  }
}

/// A fit on its way.
struct Fitting {
  Setup setup;
  std::vector<Eigen::VectorXd> first;  // the numbers of every gate at the start
  Priors beliefs;
  ThicknessPrior thickness;         // as it is believed
  std::vector<float> first_weight;  // of the pixels, before outliers lost theirs
  bool is_width_known = false;      // well enough to be free from the beginning
  PixelNoise noise;
  Solution solution;
};

// Thick walls in a narrow point spread look much like thin ones in a wide one. Both begin as they are believed to be
// and are let go step by step, so that the other numbers settle first. Of a filter in the noise the width is known
// well enough to be free from the beginning.
constexpr double tightest = 0.2;

/// Finer harmonics than the blur lets through would only fit noise.
void limit_degrees(BlurFit& options, const HeartFrame& frame, double fwhm_mm) {
  const double size = std::sqrt(frame.scale[0] * frame.scale[2]) / std::max(fwhm_mm / sigmas_per_fwhm, 3.0);
  options.uptake_degree = std::min(options.uptake_degree, std::max(3, round_int(1.6 * size)));
  options.shape_degree = std::min(options.shape_degree, std::max(4, round_int(size)));
}

Fitting begin_fit(const Study& study, const PlacedStart& placed, const Blur& blur, const BlurFit& options) {
  Fitting fit;
  fit.setup = set_up(study, placed, blur, options);
  BeatProblem& problem = fit.setup.problem;
  fit.beliefs.width = blur.uncertainty;
  fit.beliefs.stretch = 0.75 * blur.uncertainty;
  if (fit.setup.cavity > 0.6) fit.beliefs.cavity_level = fit.setup.cavity, fit.beliefs.cavity = 0.3;
  const GateLayout layout = make_gate_layout(options.shape_degree, options.wall_degree, options.uptake_degree, 0);
  fit.first = first_numbers(placed, layout, fit.setup.background, fit.beliefs.cavity_level);
  const Eigen::VectorXd uptake =
      uptake_seen(heart::mean_image(study.gates), placed, fit.setup.healthy, options.uptake_degree);
  for (Eigen::VectorXd& gate : fit.first) gate.segment(layout.uptake, uptake.size()) = uptake;
  problem.layout = make_beat_layout(layout, fit.first, fit.beliefs, fit.solution.unknowns);
  problem.noise = 0.003;
  fit.thickness = problem.thickness;
  fit.first_weight = problem.weight;
  return fit;
}

void relax_priors(Fitting& fit, double share) {
  BeatProblem& problem = fit.setup.problem;
  Solution& solution = fit.solution;
  if (problem.thickness.is_given)
    follow_slopes(problem.layout.gate, problem.cells.frame,
                  problem.layout.at_gate(problem.thickness.gate, solution.unknowns), problem.thickness);
  problem.thickness.log_sd = share * fit.thickness.log_sd;
  for (const BeatLayout::Term& t : problem.layout.terms[0][problem.layout.gate.width])
    problem.layout.spread[t.unknown] = (fit.is_width_known ? 1 : share) * fit.beliefs.width;
  // Derivatives of a blurred image are so smooth that every other pixel tells what all do. Those of a sharp one are
  // good enough for the steps; its error bars ask for all pixels. Before the last round a matrix serves the next one
  // too.
  const bool is_last = share >= 1;
  const bool is_kept = !is_last && solution.matrix.data.rows() == solution.unknowns.size();
  solution.every = is_last && problem.sigma_mm <= 0 ? 1 : 2;
  solution.matrix.priors = is_kept ? prior_matrix(problem, solution.unknowns, solution.objective) : PriorMatrix();
  solution.damping = share > tightest ? 10 : 300;
}

/// Outliers lose their weight; the noise is what the others leave.
void weigh_again(Fitting& fit) {
  reweight_outliers(fit.setup.problem, fit.first_weight, fit.setup.place, fit.solution.objective);
  fit.noise = noise_of(fit.setup.problem, fit.solution.objective);
  fit.setup.problem.noise = fit.noise.of_steps;
}

/// Lays the numbers for the images that are fitted beside the heart; unknowns that there were keep their values.
void lay_anew(Fitting& fit) {
  BeatProblem& problem = fit.setup.problem;
  const BeatLayout former = problem.layout;
  const GateLayout& old = former.gate;
  const GateLayout gate = make_gate_layout(old.endo_degree, old.wall_degree, old.uptake_degree, problem.blobs.size(),
                                           problem.attenuation.size());
  std::vector<Eigen::VectorXd> first;
  for (const Eigen::VectorXd& numbers : fit.first) {
    first.push_back(Eigen::VectorXd::Zero(gate.count()));
    first.back().head(gate.attenuation) = numbers.head(gate.attenuation);
  }
  Eigen::VectorXd unknowns;
  problem.layout = make_beat_layout(gate, first, fit.beliefs, unknowns);
  const auto keep = [&](int number, int before) {
    const auto &to = problem.layout.terms[0][number], &from = former.terms[0][before];
    for (std::size_t t = 0; t < to.size(); ++t) unknowns[to[t].unknown] = fit.solution.unknowns[from[t].unknown];
  };
  for (int number = 0; number < gate.attenuation; ++number) keep(number, number);
  for (int k = 0; k < std::min(gate.attenuation_count, old.attenuation_count); ++k)
    keep(gate.attenuation + k, old.attenuation + k);
  for (int b = 0; b < old.blob_count; ++b) keep(gate.blobs + b, old.blobs + b);
  for (int k = old.attenuation_count; k < gate.attenuation_count; ++k) {
    const int added = problem.layout.terms[0][gate.attenuation + k].front().unknown;
    unknowns[added] = problem.layout.expected[added];
  }
  fit.solution.unknowns = unknowns;
}

/// What the fit sees without attenuation, per gate.
std::vector<std::vector<float>> images_before_attenuation(const Fitting& fit) {
  const BeatProblem& problem = fit.setup.problem;
  const GateLayout& layout = problem.layout.gate;
  const Eigen::VectorXd numbers = problem.layout.at_gate(0, fit.solution.unknowns);
  std::vector<std::vector<float>> images = problem.values;
  const Eigen::VectorXf share = numbers.segment(layout.attenuation, layout.attenuation_count).cast<float>();
  for (std::size_t g = 0; g < images.size(); ++g)
    for (std::size_t n = 0; n < images[g].size(); ++n) {
      images[g][n] += fit.solution.objective.residual[g][n];
      for (int k = 0; k < layout.attenuation_count; ++k) images[g][n] -= share[k] * problem.attenuation[k][g][n];
    }
  return images;
}

/// Amplitude of the usual attenuation; 0 where it is not looked for.
double attenuation_seen(const Fitting& fit) {
  const BeatLayout& layout = fit.setup.problem.layout;
  return layout.gate.attenuation_count == 0 ? 0 : layout.at_gate(0, fit.solution.unknowns)[layout.gate.attenuation];
}

/// The images that attenuation adds, as the fit stands.
void renew_attenuation(Fitting& fit, const Study& study) {
  BeatProblem& problem = fit.setup.problem;
  problem.attenuation = attenuation_images(study, problem.pixels, problem.cells.frame, fit.setup.unit,
                                           images_before_attenuation(fit), fit.first_weight);
  lay_anew(fit);
  fit.solution.matrix = {};
}

/// Attenuation is looked for, and given up where the image shows too little of it to matter.
void look_for_attenuation(Fitting& fit, const Study& study, double share) {
  constexpr double least = 0.05;
  if (share <= tightest) return renew_attenuation(fit, study);
  if (fit.setup.problem.attenuation.empty()) return;
  if (attenuation_seen(fit) > least) return renew_attenuation(fit, study);
  fit.setup.problem.attenuation.clear();
  lay_anew(fit);
  fit.solution.matrix = {};
}

bool is_spect(const Study& study) { return study.modality != "PT" && study.modality != "MR" && study.modality != "CT"; }

/// What the reconstruction did about attenuation. Behind filtered backprojection hardly anybody corrects it.
Attenuation attenuation_of(const Study& study, const BlurFit& options, bool is_filtered) {
  if (options.attenuation != Attenuation::unknown) return options.attenuation;
  if (!is_spect(study)) return Attenuation::unknown;
  return study.attenuation == Attenuation::unknown && is_filtered ? Attenuation::uncorrected : study.attenuation;
}

double fwhm_seen(const Fitting& fit, const Blur& blur) {
  const BeatLayout& layout = fit.setup.problem.layout;
  return blur.fwhm_mm * own::exp(layout.at_gate(0, fit.solution.unknowns)[layout.gate.width]);
}

/// What is known of the errors that the fit itself does not see.
Corrections corrections_of(const Fitting& fit, const FitStart& start, const Blur& blur, const BlurFit& options,
                           Attenuation attenuation, bool is_spect) {
  const Reconstruction seen{.fwhm_mm = blur.fwhm_mm > 0 ? fwhm_seen(fit, blur) : 0,
                            .misfit = std::min(1.0, fit.noise.misfit_seen / usual_misfit),
                            .attenuation = attenuation,
                            .is_filtered = fit.is_width_known,
                            .is_thickness_given = fit.thickness.is_given,
                            .is_spect = is_spect};
  Corrections known = camera_errors(seen, start.edge_ml);
  known.noise = fit.noise.of_errors;
  known.papillary_share = options.papillary_share;
  return known;
}

/// Says where the reported walls lie. Points that a person placed lie on them, no longer on the fitted ones.
void settle_on_reported_walls(BeatProblem& problem, Solution& solution, const Corrections& known,
                              const Progress& progress) {
  constexpr int most_steps = 8;
  problem.reported = reported_walls(problem, solution, known);
  if (!problem.points.empty()) minimise(problem, solution, most_steps, 1e-3, progress);
}

/// Looks for hot spots beside the heart and lets the fit explain them. Returns how many there are.
int add_extracardiac_sources(Fitting& fit, double fwhm_mm) {
  // Of a sharp image nothing beside the heart spills over the wall: what is left there is doubted, not modelled.
  if (!(fwhm_mm > 0)) return 0;
  BeatProblem& problem = fit.setup.problem;
  std::vector<bool> beside;
  for (const Place& place : fit.setup.place)
    beside.push_back(place.outside_mm > 0.25 * fwhm_mm && place.above_mm < fwhm_mm);
  const std::vector<ExtracardiacSource> blobs =
      find_extracardiac_sources(problem, fit.solution.objective, beside, least_spot, most_spots);
  if (blobs.empty()) return 0;
  for (const ExtracardiacSource& blob : blobs) problem.blobs.push_back(blob_image(problem, blob));
  lay_anew(fit);
  return blobs.size();
}

/// The grid of the pixels that the fit compares.
Grid grid_of(const Pixels& pixels, const Grid& study) {
  Grid grid = study;
  grid.dims = pixels.count;
  for (int a = 0; a < 3; ++a) grid.spacing[a] *= pixels.joined[a];
  grid.origin = to_world(study, {pixels.centre(0, 0), pixels.centre(1, 0), pixels.centre(2, 0)});
  return grid;
}

FitImages images_of(const BeatProblem& problem, const Objective& objective, const Grid& study) {
  const Grid grid = grid_of(problem.pixels, study);
  FitImages images;
  for (std::size_t g = 0; g < problem.values.size(); ++g) {
    Image data(grid), model(grid);
    data.values = problem.values[g];
    for (std::size_t n = 0; n < grid.size(); ++n) model.values[n] = data.values[n] + objective.residual[g][n];
    images.data.push_back(std::move(data));
    images.model.push_back(std::move(model));
  }
  images.weight = Image(grid);
  images.weight.values = problem.weight;
  const float most = *std::max_element(problem.weight.begin(), problem.weight.end());
  if (most > 0)
    for (float& w : images.weight.values) w /= most;
  return images;
}

/// Ends the fitted walls where a person says. The walls themselves are those of the whole image: were it explained by a
/// ventricle that is too short, that one would be too wide.
void end_walls_as_said(const FitStart& start, const Grid& grid, const HeartFrame& frame, const BeatLayout& layout,
                       Eigen::VectorXd& unknowns) {
  if (!start.placed_base && start.base_shift_mm == 0) return;
  const auto of_number = [&](int number) { return layout.terms[0][number].front().unknown; };
  const int plane = layout.gate.plane;
  double& height = unknowns[of_number(plane)];
  double& along_x = unknowns[of_number(plane + 1)];
  double& along_y = unknowns[of_number(plane + 2)];
  if (start.placed_base) {
    for (const BeatLayout::Term& term : layout.terms[0][plane]) unknowns[term.unknown] = 0;
    const heart::BasePlane base = to_grid(grid, *start.placed_base);
    const Vec3 normal = frame.axes.transpose() * base.normal, point = frame.to_heart(base.point);
    along_x = -normal[0] / normal[2], along_y = -normal[1] / normal[2];
    height = point[2] - along_x * point[0] - along_y * point[1];
  }
  const Vec3 shift =
      start.base_shift_mm * (frame.axes.transpose() * (grid.direction.transpose() * start.axis.normalized()));
  height += shift[2] - along_x * shift[0] - along_y * shift[1];
}

/// What the image shows of its reconstruction.
void tell_reconstruction(const Study& study, const Blur& blur, const std::optional<Refiltered>& refiltered,
                         const Fitting& fit, FittedBeat& beat) {
  if (refiltered) beat.notes.push_back({Severity::info, "fit.filter_exchanged", refiltered->note});
  if (study.gates.size() == 1 && blur.fwhm_mm > 0 && is_spect(study))
    beat.notes.push_back({Severity::warning, "fit.ungated",
                          "one gate does not show what the reconstruction did (filter, attenuation): behind a camera "
                          "walls were read half as thick again"});
  if (const double seen = attenuation_seen(fit); seen > 0) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the image shows attenuation that its reconstruction did not correct: %.1f of what is usual", seen);
    beat.notes.push_back({Severity::info, "fit.attenuation", text});
  }
}

}  // namespace

FittedBeat fit_through_blur(const Study& original, const FitStart& start, const BlurFit& requested,
                            const Progress& progress) {
  BlurFit options = requested;
  check_options(options, "fit");
  std::optional<TraceStage> noted(std::in_place, "fit: start");
  const PlacedStart placed = place_start(start, original.grid());
  const Blur as_stored = blur_of(original, options);
  const std::optional<Refiltered> refiltered = without_lobes(original, placed, as_stored, options);
  const Study& study = refiltered ? refiltered->study : original;
  const Blur blur = refiltered ? refiltered->blur : as_stored;
  // Sharp images show papillary muscles as they are.
  if (!(blur.fwhm_mm > 0)) options.papillary_share = 0;
  limit_degrees(options, placed.frame, blur.fwhm_mm);
  Fitting fit = begin_fit(study, placed, blur, options);
  fit.is_width_known = refiltered.has_value();
  BeatProblem& problem = fit.setup.problem;
  Solution& solution = fit.solution;

  noted.reset();
  FittedBeat beat;
  relax_priors(fit, tightest);
  minimise(problem, solution, 10, 1e-2, progress);
  beat.extracardiac_sources = add_extracardiac_sources(fit, blur.fwhm_mm);
  if (beat.extracardiac_sources == most_spots)
    beat.notes.push_back({Severity::info, "fit.most_sources",
                          "beside the heart " + std::to_string(most_spots) +
                              " sources were fitted, the most that are; the intervals were learned with as many"});
  const Attenuation attenuation = attenuation_of(study, options, refiltered.has_value());
  const bool may_be_attenuated =
      attenuation != Attenuation::corrected && blur.fwhm_mm > 0 && study.modality != "PT" && study.gates.size() > 1;
  for (const double share : {tightest, 0.4, 1.0}) {
    if (may_be_attenuated) look_for_attenuation(fit, study, share);
    relax_priors(fit, share);
    weigh_again(fit);
    if (share < 1)
      minimise(problem, solution, 8, 1e-2, progress);
    else
      minimise(problem, solution, std::max(1, options.most_steps - solution.steps), 1e-3, progress);
  }

  const Corrections known = corrections_of(fit, start, blur, options, attenuation, is_spect(study));
  settle_on_reported_walls(problem, solution, known, progress);

  tell_reconstruction(study, blur, refiltered, fit, beat);
  noted.emplace("fit: intervals");
  beat.steps = solution.steps;
  beat.objective = solution.objective.value;
  beat.converged = solution.converged;
  beat.images = images_of(problem, solution.objective, study.grid());
  end_walls_as_said(start, study.grid(), placed.frame, problem.layout, solution.unknowns);
  describe_beat(problem, solution, known, study.grid(), beat);
  tell_camera_errors(problem, solution, known, beat);
  beat.fwhm_mm.value = fwhm_seen(fit, blur);
  // Of its log until here. Cameras differ from one Gaussian: so widened, the interval holds the truth in 90 % of the
  // choosing patients of experiments/unbiased_200.
  if (beat.fwhm_mm.sd > 0) beat.fwhm_mm.sd = beat.fwhm_mm.value * own::hypot(2 * beat.fwhm_mm.sd, 0.015);
  return beat;
}

}  // namespace dynasurf::psf_fit
