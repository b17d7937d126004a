#include "dynasurf/ventricle/readings.hpp"

#include <cmath>

#include "dynasurf/ventricle/cycle.hpp"
#include "dynasurf/ventricle/fit/wall_posterior.hpp"
#include "dynasurf/ventricle/measures/regional_errors.hpp"

namespace dynasurf {
namespace {

/// An image without blur has no Gaussian across its wall: deviations without end would be shown as volumes.
void drop_unlikely_reading(VentricleResult& result) {
  if (!result.qgs_like) return;
  constexpr double most = 3;  // times the outer edge surface
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const double outer_ml = result.qgs_like->cavity_ml[g] + result.qgs_like->wall_ml[g];
    if (std::isfinite(outer_ml) && outer_ml < most * result.gates[g].epi->volume_ml) continue;
    result.qgs_like.reset();
    result.notes.push_back(
        {Severity::info, "readings.no_gaussian", "no QGS-like reading: no asymmetric Gaussian fits across this wall"});
    return;
  }
}

/// False where the fit ran away from what was seen: data that are no wall seen through a blur.
bool is_plausible(const VentricleResult& result) {
  constexpr double most = 4;  // times the outer edge surface, or a part of it
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const double fitted = result.fit->gates[g].epi_ml.value / result.gates[g].epi->volume_ml;
    if (!(fitted > 1 / most && fitted < most) || !(result.fit->gates[g].endo_ml.value > 0)) return false;
  }
  return std::isfinite(result.fit->edv_ml.sd + result.fit->esv_ml.sd + result.fit->wall_ml.sd);
}

}  // namespace

void measure_cycle(VentricleResult& result) {
  std::vector<double> cavity, wall;
  for (const Gate& gate : result.gates) {
    if (gate.endo) cavity.push_back(gate.endo->volume_ml);
    if (gate.wall_ml) wall.push_back(*gate.wall_ml);
  }
  if (cavity.size() == result.gates.size()) {
    if (const std::optional<Function> f = left_ventricular_function(cavity)) {
      result.edv_ml = f->edv_ml, result.esv_ml = f->esv_ml, result.sv_ml = f->sv_ml;
      result.ef_percent = f->ef_percent;
      result.ed_gate = f->ed_gate, result.es_gate = f->es_gate;
    }
    result.phases = phases_of_curve(cavity);
  }
  if (wall.size() == result.gates.size() && wall.size() > 1) result.wall_variation = coefficient_of_variation(wall);
}

void read_otherwise(const Study& original, const BlurFit& options, const Progress& progress, StageClock& clock,
                    VentricleResult& result) {
  FitStart start;
  for (const Gate& gate : result.gates) {
    if (!gate.endo || !gate.epi || gate.endo->volume_ml <= 0 || gate.wall_ml.value_or(0) <= 0) {
      if (options.run)
        result.notes.push_back(
            {Severity::info, "fit.no_walls",
             "no volumes freed of the blur: gate " + std::to_string(gate.gate + 1) + " has not both surfaces"});
      return;
    }
    start.endo.push_back(gate.endo->mesh);
    start.epi.push_back(gate.epi->mesh);
    start.base.push_back(gate.base_plane);
  }
  start.axis = result.study.grid().direction.col(2);
  start.lateral = result.study.grid().direction.col(0);
  // A heart that was found across the stack was not believed either when the stack was kept.
  if (result.heart && result.heart->cup.axis.dot(start.axis) > 0.7) start.cup = result.heart->cup;
  result.qgs_like = clock("readings", [&] { return read_like_qgs(original, start); });
  drop_unlikely_reading(result);
  if (!options.run) return;
  result.fit = clock("fit", [&] { return fit_through_blur(original, start, options, progress); });
  result.notes.insert(result.notes.end(), result.fit->notes.begin(), result.fit->notes.end());
  if (is_plausible(result)) return;
  result.fit.reset();
  result.notes.push_back(
      {Severity::warning, "fit.lost",
       "no volumes freed of the blur: the walls that were fitted are not those whose edges were seen"});
}

std::optional<Measures> measure_study(const VentricleResult& result, const MeasureOptions& options) {
  MeasureInput input;
  input.cycle_ms = result.study.cycle_ms;
  // A heart that was found across the stack was not believed either when the stack was kept.
  const Vec3 along_stack = result.study.grid().direction.col(2);
  input.axis = result.heart && result.heart->cup.axis.dot(along_stack) > 0.7 ? result.heart->cup.axis : along_stack;
  bool is_any = false;
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const Gate& gate = result.gates[g];
    if (result.fit) {
      const FittedGate& fitted = result.fit->gates[g];
      input.from_edges = false, is_any = true;
      input.gates.push_back({{&fitted.endo, &result.fit->uptake},
                             {&fitted.epi, &result.fit->uptake},
                             &result.study.gates[g],
                             fitted.base});
      continue;
    }
    is_any = is_any || gate.endo;
    input.gates.push_back({{gate.endo ? &gate.endo->mesh : nullptr},
                           {gate.epi ? &gate.epi->mesh : nullptr},
                           &result.study.gates[g],
                           gate.base_plane});
  }
  if (!is_any) return std::nullopt;
  Measures measures = measure_walls(input, options);
  if (result.fit && result.fit->posterior) add_error_bars(measures, *result.fit->posterior);
  return measures;
}

}  // namespace dynasurf
