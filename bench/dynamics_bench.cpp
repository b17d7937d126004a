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
  Image border = synthetic::external_border(synthetic::make_phantom(synthetic::Hebron{}).study.gates.front(), 0.2, 35);
  field::VectorField field = field::flow_field(border, field::SteadyGvf{}).field;
  field::VectorField thesis_field = field::flow_field(border, field::Gvf{}).field;
};
const Scene& scene() {
  static const Scene s;
  return s;
}

struct Named {
  const char* name;
  dynamics::Evolution model;
};
std::array<Named, 5> models() {
  return {{{"free", dynamics::free_model()},
           {"spring", dynamics::spring_model()},
           {"restricted", dynamics::restricted_spring_model()},
           {"plain", dynamics::plain_model()},
           {"curvature", dynamics::curvature_model()}}};
}

struct NamedSolver {
  const char* name;
  dynamics::SolverOptions solver;
};
std::array<NamedSolver, 6> solvers() {
  return {{{"euler", dynamics::Euler{}},
           {"midpoint", dynamics::Midpoint{}},
           {"rk4", dynamics::Rk4{}},
           {"step_doubling", dynamics::StepDoubling{}},
           {"rkf45", dynamics::Rkf45{}},
           {"backward_euler", dynamics::BackwardEuler{}}}};
}

int vertices_of(int level) { return static_cast<int>(mesh::icosphere(level).vertices.size()); }

void run(benchmark::State& state, const field::VectorField& field, const dynamics::Evolution& how, int level) {
  const ThreadLimit limit(1);
  const TriMesh start = mesh::place(mesh::icosphere(level), scene().border, {});
  dynamics::EvolutionResult r;
  for (auto _ : state) r = dynamics::evolve(start, field, scene().border, how);
  const std::vector<double> away = mesh::distances_to_border_voxels(r.mesh, scene().border);
  const auto near = std::count_if(away.begin(), away.end(), [](double d) { return d < 1; });
  state.counters["steps"] = r.steps;
  state.counters["within"] = static_cast<double>(near) / static_cast<double>(away.size());
  state.counters["step_us"] = benchmark::Counter(
      static_cast<double>(r.steps) * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.SetLabel(std::string(dynamics::name_of(r.reason)));
}

/// Fifty steps in which nobody arrives; the setting up of a run is in them.
void add_steps() {
  for (const Named& m : models())
    for (const NamedSolver& s : solvers())
      for (const int level : {2, 3, 4, 5}) {
        dynamics::Evolution how = m.model;
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

void add_run(const std::string& name, const dynamics::Evolution& how, int level) {
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
        dynamics::Evolution how = m.model;
        how.solver = s.solver;
        add_run(std::string(m.name) + "/" + s.name, how, level);
      }
  benchmark::RegisterBenchmark("to_rest/free_thesis_field/642", [](benchmark::State& state) {
    run(state, scene().thesis_field, dynamics::free_model(), 3);
  })->Unit(benchmark::kMillisecond);
  dynamics::Evolution plain = dynamics::plain_model();
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
