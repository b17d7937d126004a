// A whole study: eight gates of 64x64x23 voxels, both surfaces, from the volumes to the verdict; no files, no report.
//
//     build/bench/bin/study_bench --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//
// Counters: seconds that the stages took, summed over the gates. `CPU` counts one thread only.
#include <benchmark/benchmark.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf {
namespace {

void study(benchmark::State& state, const ventricle::Options& options) {
  static const Study cycle = synthetic::make_phantom(synthetic::CardiacCycle{}).study;
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  ventricle::Result result;
  for (auto _ : state) result = ventricle::reconstruct(cycle, options);
  for (const auto& [stage, seconds] : result.seconds) state.counters[stage] = seconds;
}
void edges(benchmark::State& state, const field::FieldOptions& field) {
  ventricle::Options options = ventricle::preset("edges");
  options.field = field;
  study(state, options);
}
void fitted(benchmark::State& state) { study(state, {}); }
void steady_fields(benchmark::State& state) { edges(state, field::SteadyGvf{}); }
void thesis_fields(benchmark::State& state) { edges(state, field::Gvf{}); }
BENCHMARK(fitted)->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(steady_fields)->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(thesis_fields)->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dynasurf
