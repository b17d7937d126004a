#include "dynasurf/ventricle/detail/readings.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/psf_fit/detail/wall_posterior.hpp"
#include "dynasurf/ventricle/detail/cycle.hpp"
#include "dynasurf/ventricle/measures/detail/regional_errors.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr std::array<std::string_view, 3> kind_names{"psf_corrected", "edge", "gaussian_profile"};

std::optional<heart::Estimate> mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  double sum = 0;
  for (const double v : values) sum += v;
  return heart::Estimate{sum / values.size()};
}

/// Volumes of the cavity and the wall over the beat, without intervals.
Reading reading_of_volumes(ReadingKind kind, const std::vector<double>& cavity_ml, const std::vector<double>& wall_ml) {
  Reading reading;
  reading.kind = kind;
  reading.wall_ml = mean_of(wall_ml);
  const std::optional<heart::LvVolumes> f = heart::lv_volumes(cavity_ml);
  if (!f) return reading;
  reading.edv_ml = heart::Estimate{f->edv_ml}, reading.esv_ml = heart::Estimate{f->esv_ml},
  reading.sv_ml = heart::Estimate{f->sv_ml};
  if (f->ef_percent) reading.ef_percent = heart::Estimate{*f->ef_percent};
  reading.ed_gate = f->ed_gate, reading.es_gate = f->es_gate;
  return reading;
}

/// The heart as it was located, where the stack was cut along it: one that was found across the stack was not believed
/// when the stack was kept.
const heart::Location* heart_along_stack(const Result& result) {
  const Vec3 along = result.study.grid().direction.col(2);
  return result.heart && result.heart->cup.axis.dot(along) > 0.7 ? &*result.heart : nullptr;
}

bool is_heart_believed(const Result& result) {
  const heart::Location* heart = heart_along_stack(result);
  return heart != nullptr && heart->is_believed();
}

bool has_walls(const EdgeSurfaces& edge) {
  return edge.endo && edge.epi && edge.endo->volume_ml > 0 && edge.wall_ml.value_or(0) > 0;
}

/// What a reading's outer surface is held against, one per gate: the middle of the wall of a heart that is believed,
/// else the outer edge surface.
std::vector<double> outer_ml(const Result& result) {
  std::vector<double> volumes;
  for (const Gate& gate : result.gates)
    volumes.push_back(is_heart_believed(result) ? heart::volume_mm3(result.heart->cup) / 1000
                                                : gate.edge_surfaces.epi->volume_ml);
  return volumes;
}

/// False where the fit diverged from what is seen: data that are no wall seen through a point spread.
bool is_plausible(const psf_fit::FittedBeat& beat, std::span<const double> outer_ml) {
  constexpr double most = 4;  // times what is seen, or a part of it
  for (std::size_t g = 0; g < beat.gates.size(); ++g) {
    const double ratio = beat.gates[g].epi_ml.value / outer_ml[g];
    if (!(ratio > 1 / most && ratio < most) || !(beat.gates[g].endo_ml.value > 0)) return false;
  }
  return std::isfinite(beat.edv_ml.sd + beat.esv_ml.sd + beat.wall_ml.sd);
}

/// An image without blur has no Gaussian across its wall: deviations without end would be shown as volumes.
bool is_plausible(const psf_fit::GaussianProfile& profile, std::span<const double> outer_ml) {
  constexpr double most = 3;  // times what is seen
  for (std::size_t g = 0; g < profile.cavity_ml.size(); ++g) {
    const double read_ml = profile.cavity_ml[g] + profile.wall_ml[g];
    if (!(std::isfinite(read_ml) && read_ml < most * outer_ml[g])) return false;
  }
  return true;
}

/// A valve plane that a person placed or moved: the fit looks for its own, and ends its walls there afterwards.
void end_as_said(const Result& result, const UserOverrides& manual, psf_fit::FitStart& start) {
  start.base_shift_mm = manual.base_shift_mm.value_or(0);
  if (manual.base_plane_mm) {
    start.placed_base = level_plane(result.study.grid(), *manual.base_plane_mm);
    if (start.cup) std::fill(start.base.begin(), start.base.end(), std::nullopt);
  }
  for (auto& base : start.base)
    if (base) base->point -= start.base_shift_mm * start.axis;
}

/// What a fit begins with: a heart that is believed, or both surfaces of all gates. Absent, with a note where one
/// was asked for, without either.
std::optional<psf_fit::FitStart> fit_start_of(const Result& result, bool is_asked_for, Notes& notes) {
  psf_fit::FitStart start;
  const heart::Location* heart = heart_along_stack(result);
  for (const Gate& gate : result.gates) {
    const EdgeSurfaces& edge = gate.edge_surfaces;
    if (!has_walls(edge) && !is_heart_believed(result)) {
      if (is_asked_for)
        notes.push_back({Severity::info, "fit.no_walls",
                         "no PSF-corrected volumes: gate " + std::to_string(gate.gate + 1) + " has not both surfaces"});
      return std::nullopt;
    }
    start.endo.push_back(edge.endo ? edge.endo->mesh : TriMesh{});
    start.epi.push_back(edge.epi ? edge.epi->mesh : TriMesh{});
    start.base.push_back(edge.base_plane);
  }
  start.axis = result.study.grid().direction.col(2);
  start.lateral = result.study.grid().direction.col(0);
  if (heart) start.cup = heart->cup;
  return start;
}

LeadingSurfaces surfaces_of(const psf_fit::FittedGate& fitted) {
  return {LeadingSurface{fitted.endo, fitted.endo_ml}, LeadingSurface{fitted.epi, fitted.epi_ml}, fitted.base};
}

LeadingSurfaces surfaces_of(const EdgeSurfaces& edge) {
  LeadingSurfaces surfaces;
  if (edge.endo) surfaces.endo = LeadingSurface{edge.endo->mesh, {edge.endo->volume_ml}};
  if (edge.epi) surfaces.epi = LeadingSurface{edge.epi->mesh, {edge.epi->volume_ml}};
  surfaces.base_plane = edge.base_plane;
  return surfaces;
}

/// Border points are told to the fit alone.
void tell_unused_points(const Options& options, Notes& notes) {
  if (options.manual.endo_points.empty() && options.manual.epi_points.empty()) return;
  notes.push_back({Severity::warning, "points.without_fit",
                   "options manual.endo_points and manual.epi_points had no effect: there is no fit"});
}

}  // namespace

std::span<const std::string_view> names_of(ReadingKind) { return kind_names; }

Reading reading_of(const psf_fit::FittedBeat& beat) {
  Reading reading;
  reading.kind = ReadingKind::psf_corrected;
  reading.wall_ml = beat.wall_ml;
  if (beat.gates.size() < 2) return reading;
  reading.edv_ml = beat.edv_ml, reading.esv_ml = beat.esv_ml, reading.sv_ml = beat.sv_ml;
  reading.ef_percent = beat.ef_percent;
  reading.ed_gate = beat.ed_gate, reading.es_gate = beat.es_gate;
  return reading;
}

Reading reading_of(const psf_fit::GaussianProfile& profile) {
  return reading_of_volumes(ReadingKind::gaussian_profile, profile.cavity_ml, profile.wall_ml);
}

void measure_cycle(Result& result) {
  std::vector<double> cavity, wall;
  for (const Gate& gate : result.gates) {
    if (gate.edge_surfaces.endo) cavity.push_back(gate.edge_surfaces.endo->volume_ml);
    if (gate.edge_surfaces.wall_ml) wall.push_back(*gate.edge_surfaces.wall_ml);
  }
  if (cavity.size() != result.gates.size()) cavity.clear();
  if (wall.size() != result.gates.size()) wall.clear();
  result.readings.edge = reading_of_volumes(ReadingKind::edge, cavity, wall);
  if (wall.size() > 1) result.wall_variation = heart::coefficient_of_variation(wall);
}

OtherReadings read_otherwise(const Study& original, const std::optional<Mask>& looked_at, const Options& all,
                             const Progress& progress, StageClock& clock, const Result& result) {
  const psf_fit::BlurFit& options = all.fit;
  OtherReadings readings;
  auto& [beat, profile, notes] = readings;
  std::optional<psf_fit::FitStart> start = fit_start_of(result, options.run, notes);
  if (start) {
    start->looked_at = looked_at;
    profile = clock("readings", [&] { return psf_fit::read_gaussian_profile(original, *start); });
    if (profile && !is_plausible(*profile, outer_ml(result))) {
      profile.reset();
      notes.push_back({Severity::info, "readings.no_gaussian",
                       "no Gaussian-profile reading: no asymmetric Gaussian fits across this wall"});
    }
  }
  if (!start || !options.run) {
    tell_unused_points(all, notes);
    return readings;
  }
  // What is usual of edges was learned of these, and behind gamma cameras.
  const bool are_all_there = std::all_of(result.gates.begin(), result.gates.end(),
                                         [](const Gate& gate) { return has_walls(gate.edge_surfaces); });
  if (are_all_there && all.pipeline == Pipeline::surface && original.modality != "PT")
    for (const Gate& gate : result.gates) start->edge_ml.push_back(gate.edge_surfaces.endo->volume_ml);
  end_as_said(result, all.manual, *start);
  start->points = wall_points(all.manual, original);
  beat = clock("fit", [&] { return psf_fit::fit_through_blur(original, *start, options, progress); });
  notes.insert(notes.end(), beat->notes.begin(), beat->notes.end());
  if (is_plausible(*beat, outer_ml(result))) return readings;
  beat.reset();
  notes.push_back({Severity::warning, "fit.lost",
                   "no PSF-corrected volumes: the fit diverged from the wall that is seen and was discarded"});
  return readings;
}

void choose_leading(Result& result) {
  const auto& beat = result.readings.psf_corrected;
  result.leading = beat ? reading_of(*beat) : result.readings.edge;
  std::vector<double> cavity_ml;
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    Gate& gate = result.gates[g];
    gate.surfaces = beat ? surfaces_of(beat->gates[g]) : surfaces_of(gate.edge_surfaces);
    if (gate.surfaces.endo) cavity_ml.push_back(gate.surfaces.endo->volume_ml.value);
  }
  if (cavity_ml.size() == result.gates.size()) result.phases = heart::phases_of_curve(cavity_ml);
}

std::optional<Measures> measure_study(const Result& result, const MeasureOptions& options) {
  const auto& beat = result.readings.psf_corrected;
  MeasureInput input;
  input.cycle_ms = result.study.cycle_ms;
  if (beat) input.from_edges = false;
  const heart::Location* heart = heart_along_stack(result);
  input.axis = heart ? heart->cup.axis : Vec3(result.study.grid().direction.col(2));
  bool is_any = false;
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const LeadingSurfaces& surfaces = result.gates[g].surfaces;
    const auto wall = [&](const std::optional<LeadingSurface>& surface) {
      return WallSide{surface ? &surface->mesh : nullptr, beat ? &beat->uptake : nullptr};
    };
    is_any = is_any || surfaces.endo;
    input.gates.push_back({wall(surfaces.endo), wall(surfaces.epi), &result.study.gates[g], surfaces.base_plane});
  }
  if (!is_any) return std::nullopt;
  Measures measures = measure_walls(input, options);
  if (beat && beat->posterior) add_error_bars(measures, *beat->posterior);
  return measures;
}

}  // namespace dynasurf::ventricle
