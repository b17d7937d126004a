#pragma once
#include <variant>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/field/band.hpp"
#include "dynasurf/field/detail/flow_result.hpp"
#include "dynasurf/field/steady.hpp"

namespace dynasurf::field {

/// Explicit gradient vector flow (FLD-GVF, thesis 3.3.4 and 4.5).
struct Gvf {
  static constexpr std::string_view name = "gvf";
  double mu = 2;
  int iterations = 150;
  double residual = 0;
  double step_divisor = 16;
  GvfScheme scheme = GvfScheme::thesis;
  bool safe_step = true;
};
void describe(auto& visit, Gvf& o) {
  visit("mu", o.mu, OptionInfo{"balance: 0 keeps the gradient, large spreads it (thesis 3.36)", "", 1e-6, 1e4});
  visit("iterations", o.iterations, OptionInfo{"most steps", "", 1, 10000000});
  visit(
      "residual", o.residual,
      OptionInfo{"stop when no component changes faster than this; 0 runs all iterations", "1/mm per unit of time", 0});
  visit("step_divisor", o.step_divisor,
        OptionInfo{"the step is dx dy dz / (divisor * mu) (thesis 4.51)", "", 0.1, 1e6});
  visit("scheme", o.scheme, OptionInfo{"thesis: as printed; metric: equal spread in mm"});
  visit("safe_step", o.safe_step, OptionInfo{"shorten a step that the stability bound forbids, with a note"});
}

/// Explicit generalised gradient vector flow (FLD-GGVF, thesis 3.39-3.42): v_t = g lap(v) - h (v - grad f) with
/// g = exp(-|grad f|/K) and h = 1 - g. Strong gradients are kept, and the field spreads where there are none, so that
/// it enters narrower indentations than `Gvf`.
struct Ggvf {
  static constexpr std::string_view name = "ggvf";
  double k = 0.1;
  int iterations = 150;
  double residual = 0;
  double step_divisor = 16;
  GvfScheme scheme = GvfScheme::thesis;
  bool safe_step = true;
};
void describe(auto& visit, Ggvf& o) {
  visit("k", o.k,
        OptionInfo{"K as a share of the largest gradient: small keeps weak gradients (thesis 3.42)", "", 0.01, 100});
  visit("iterations", o.iterations, OptionInfo{"most steps", "", 1, 10000000});
  visit(
      "residual", o.residual,
      OptionInfo{"stop when no component changes faster than this; 0 runs all iterations", "1/mm per unit of time", 0});
  visit("step_divisor", o.step_divisor,
        OptionInfo{"the step is dx dy dz / divisor (thesis 4.51 with mu 1)", "", 0.1, 1e6});
  visit("scheme", o.scheme, OptionInfo{"thesis: as printed; metric: equal spread in mm"});
  visit("safe_step", o.safe_step, OptionInfo{"shorten a step that the stability bound forbids, with a note"});
}

/// The methods that make a field of an edge map.
using FieldOptions = std::variant<Gvf, SteadyGvf, SteadyGgvf, Ggvf, BandGvf, BandGgvf>;

/// Gradient vector flow of an edge map that is high on borders: vectors point towards borders from both sides.
/// Starts from the gradient of the map (central differences in mm, one-sided on the grid's faces); neighbours beyond
/// the grid repeat its border. A linear map stays at its gradient; a constant map gives a zero field after 0
/// iterations. Any size from 1x1x1: an axis of one voxel plays no part, so a single slice is the two-dimensional case
/// with the step dx dy / (divisor * mu). The same bytes for any number of threads. Throws OptionError for an option out
/// of range, InputError for a map that is empty or not finite.
FlowResult flow_field(const Image& edge_map, const Gvf& options, const Progress& progress = {});
FlowResult flow_field(const Image& edge_map, const Ggvf& options, const Progress& progress = {});
FlowResult flow_field(const Image& edge_map, const FieldOptions& options, const Progress& progress = {});

/// The largest stable time step of the explicit scheme, 2 / (max |grad f|^2 + 4 x the sum of the diffusion rates): the
/// data term and all three axes count (A.1, E15). `safe_step` stays 5 % below it.
double stable_step(const Image& edge_map, const Gvf& options);
/// The same with h, which is below 1, in the place of |grad f|^2 and mu 1.
double stable_step(const Image& edge_map, const Ggvf& options);

}  // namespace dynasurf::field
