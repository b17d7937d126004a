// Deformable models on the outer border of the Hebron phantom: a step of each model with each solver, and whole runs.
//
//     build/bench/bin/dynamics_bench --benchmark_repetitions=5 --benchmark_enable_random_interleaving=true
//
// One thread. The field, at rest but where a name says `thesis`, is there before the clock starts. Counters: `steps` of
// the run, `within` the share of its particles closer than a voxel to the border, `step_us` the time of a step.
#include <algorithm>
#include <array>
#include <string>

#include <benchmark/benchmark.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/detail/voxel_truth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf {
namespace {

struct Scene {
  Image border = external_border(make_phantom(Hebron{}).study.gates.front(), 0.2, 35);
  VectorField field = flow_field(border, SteadyGvf{}).field;
  VectorField thesis_field = flow_field(border, Gvf{}).field;
};
const Scene& scene() {
  static const Scene s;
  return s;
}

struct Named {
  const char* name;
  Evolution model;
};
std::array<Named, 5> models() {
  return {{{"free", free_model()},
           {"spring", spring_model()},
           {"restricted", restricted_spring_model()},
           {"plain", plain_model()},
           {"curvature", curvature_model()}}};
}

struct NamedSolver {
  const char* name;
  SolverOptions solver;
};
std::array<NamedSolver, 6> solvers() {
  return {{{"euler", Euler{}},
           {"midpoint", Midpoint{}},
           {"rk4", Rk4{}},
           {"step_doubling", StepDoubling{}},
           {"rkf45", Rkf45{}},
           {"backward_euler", BackwardEuler{}}}};
}

int vertices_of(int level) { return static_cast<int>(icosphere(level).vertices.size()); }

void run(benchmark::State& state, const VectorField& field, const Evolution& how, int level) {
  const ThreadLimit limit(1);
  const TriMesh start = place(icosphere(level), scene().border, {});
  EvolutionResult r;
  for (auto _ : state) r = evolve(start, field, scene().border, how);
  const std::vector<double> away = distances_to_border_voxels(r.mesh, scene().border);
  const auto near = std::count_if(away.begin(), away.end(), [](double d) { return d < 1; });
  state.counters["steps"] = r.steps;
  state.counters["within"] = static_cast<double>(near) / static_cast<double>(away.size());
  state.counters["step_us"] = benchmark::Counter(
      static_cast<double>(r.steps) * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.SetLabel(std::string(name_of(r.reason)));
}

/// Fifty steps in which nobody arrives; the setting up of a run is in them.
void add_steps() {
  for (const Named& m : models())
    for (const NamedSolver& s : solvers())
      for (const int level : {2, 3, 4, 5}) {
        Evolution how = m.model;
        how.solver = s.solver;
        how.stop.enabled = false;
        how.smooth_after.sweeps = 0;
        how.step_s = 1e-5;  // below the limits of 10242 vertices, too: the solvers that cut steps need not
        how.end.max_steps = 50;
        how.end.still_share = 1;
        how.end.still_move = 0;
        benchmark::RegisterBenchmark(
            (std::string("steps/") + m.name + "/" + s.name + "/" + std::to_string(vertices_of(level))).c_str(),
            [how, level](benchmark::State& state) { run(state, scene().field, how, level); })
            ->Unit(benchmark::kMillisecond);
      }
}

void add_run(const std::string& name, const Evolution& how, int level) {
  benchmark::RegisterBenchmark(("to_rest/" + name + "/" + std::to_string(vertices_of(level))).c_str(),
                               [how, level](benchmark::State& state) { run(state, scene().field, how, level); })
      ->Unit(benchmark::kMillisecond);
}

/// From a start 1.5 times as large as the data until all is at rest, or as far as `max_steps` reach: the label says
/// which.
void add_runs() {
  for (const Named& m : models())
    for (const NamedSolver& s : solvers())
      for (const int level : {2, 3, 4, 5}) {
        Evolution how = m.model;
        how.solver = s.solver;
        add_run(std::string(m.name) + "/" + s.name, how, level);
      }
  benchmark::RegisterBenchmark("to_rest/free_thesis_field/642", [](benchmark::State& state) {
    run(state, scene().thesis_field, free_model(), 3);
  })->Unit(benchmark::kMillisecond);
  Evolution plain = plain_model();
  plain.step_s = 0.05;
  add_run("plain_dt_0.05", plain, 3);
}

const bool registered = [] {
  add_steps();
  add_runs();
  return true;
}();

}  // namespace
}  // namespace dynasurf
