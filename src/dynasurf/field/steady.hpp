#pragma once
#include <memory>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/field/detail/flow_result.hpp"

namespace dynasurf::field {

/// Gradient vector flow at rest: the field that the explicit scheme reaches after tens of thousands of steps, solved
/// for directly. Per component (b - mu lap) u = b f_x with b = |grad f|^2 and Neumann borders (thesis 3.36).
struct SteadyGvf {
  static constexpr std::string_view name = "steady";
  double mu = 0.2;
  double tolerance = 1e-3;
  GvfScheme scheme = GvfScheme::metric;
  int most_cycles = 40;
};
void describe(auto& visit, SteadyGvf& o) {
  visit("mu", o.mu, OptionInfo{"balance: 0 keeps the gradient, large spreads it (thesis 3.36)", "", 1e-6, 1e4});
  visit("tolerance", o.tolerance,
        OptionInfo{"stop below this relative distance from the converged field", "", 1e-6, 0.1});
  visit("scheme", o.scheme, OptionInfo{"thesis: diffusion over the voxel's volume; metric: equal spread in mm"});
  visit("most_cycles", o.most_cycles, OptionInfo{"give up with a note after this many cycles", "", 1, 1000});
}

/// Generalised gradient vector flow at rest (thesis 3.39-3.42): g lap(v) = h (v - grad f), g = exp(-|grad f|/K),
/// h = 1 - g. Divided by g it is the same problem with b = h/g and mu 1. Enters narrow indentations further than GVF.
struct SteadyGgvf {
  static constexpr std::string_view name = "steady_ggvf";
  double k = 0.1;
  double tolerance = 1e-3;
  int most_cycles = 40;
};
void describe(auto& visit, SteadyGgvf& o) {
  visit("k", o.k,
        OptionInfo{"K as a share of the largest gradient: small keeps weak gradients (thesis 3.42)", "", 0.01, 100});
  visit("tolerance", o.tolerance,
        OptionInfo{"stop below this relative distance from the converged field", "", 1e-6, 0.1});
  visit("most_cycles", o.most_cycles, OptionInfo{"give up with a note after this many cycles", "", 1, 1000});
}

/// Memory of a solver, kept from field to field: for small grids, touching fresh memory costs as much as the solution.
/// One workspace serves one call at a time.
class SteadyWorkspace {
 public:
  SteadyWorkspace();
  ~SteadyWorkspace();
  SteadyWorkspace(SteadyWorkspace&&) noexcept;
  SteadyWorkspace& operator=(SteadyWorkspace&&) noexcept;
  std::size_t bytes() const;  // reserved; voxels around which the map is flat need least

  struct Levels;
  std::unique_ptr<Levels> levels;
};

/// The converged field, by full multigrid: the work grows with the number of voxels and with nothing else. Any size
/// from 1x1x1 and any spacing. `FlowResult::error` estimates the relative distance from the exact solution out of the
/// last corrections; a note "steady.tolerance_missed" says when single precision or `most_cycles` ended the run above
/// `tolerance`. Same bytes for any number of threads. A constant map gives a zero field. Throws like the explicit
/// scheme. A thread keeps the memory of its last field, up to 16 MiB, for the next one.
FlowResult flow_field(const Image& edge_map, const SteadyGvf& options, const Progress& progress = {});
FlowResult flow_field(const Image& edge_map, const SteadyGgvf& options, const Progress& progress = {});

/// The same into memory that is there already: `result.field` is reused where its grid has the size of the map's.
void flow_field(const Image& edge_map, const SteadyGvf& options, SteadyWorkspace& workspace, FlowResult& result,
                const Progress& progress = {});
void flow_field(const Image& edge_map, const SteadyGgvf& options, SteadyWorkspace& workspace, FlowResult& result,
                const Progress& progress = {});

}  // namespace dynasurf::field
