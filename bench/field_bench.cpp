// Gradient vector flow: the steady solver beside the plain explicit scheme, in one run.
//
//     build/bench/bin/field_bench --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//
// The counter `error` is the solver's estimate, `cycles` the cycles on the voxels, `bytes_per_voxel` the memory that
// the workspace has reserved (blocks without data in it are never touched) without map and result.
#include <cmath>

#include <benchmark/benchmark.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/gvf.hpp"

namespace dynasurf {
namespace {

/// A closed bumpy border one voxel thick. `size` 64 is a gated study, 64x64x23 at 2.87 x 2.87 x 5.74 mm; others are
/// cubes of 1 mm.
Image border_map(int size) {
  Grid g;
  g.dims = {size, size, size == 64 ? 23 : size};
  if (size == 64) g.spacing = {2.87, 2.87, 5.74};
  const double width = size * g.spacing[0];
  const auto inside = [&](int i, int j, int k) {
    const Vec3 centre = Vec3(g.dims[0] - 1, g.dims[1] - 1, g.dims[2] - 1).cwiseProduct(g.spacing) / 2;
    const Vec3 p = centre_of(g, {i, j, k}) - centre;
    const double r = p.norm(), theta = std::acos(p[2] / (r + 1e-9)), phi = std::atan2(p[1], p[0]);
    return r < 0.25 * width * (1 + 0.22 * std::sin(3 * theta) * std::cos(4 * phi) + 0.08 * std::cos(5 * theta));
  };
  Volume<std::uint8_t> solid(g);
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) solid(i, j, k) = inside(i, j, k);
  Image border(g);
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i)
        border(i, j, k) = solid(i, j, k) &&
                          !(solid.clamped(i - 1, j, k) && solid.clamped(i + 1, j, k) && solid.clamped(i, j - 1, k) &&
                            solid.clamped(i, j + 1, k) && solid.clamped(i, j, k - 1) && solid.clamped(i, j, k + 1));
  return border;
}

double mu_of(int size) { return size == 64 ? 0.15 : size == 62 ? 2 : 0.2; }

/// size, threads, tolerance as a power of ten
void steady(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const Image map = border_map(size);
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  const SteadyGvf options{.mu = mu_of(size), .tolerance = std::pow(10.0, -static_cast<double>(state.range(2)))};
  SteadyWorkspace workspace;
  FlowResult result;
  for (auto _ : state) flow_field(map, options, workspace, result);
  state.counters["cycles"] = result.iterations;
  state.counters["error"] = *result.error;
  state.counters["bytes_per_voxel"] = static_cast<double>(workspace.bytes()) / static_cast<double>(map.grid.size());
}
BENCHMARK(steady)
    ->ArgsProduct({{64, 62, 128}, {1, 2}, {2, 3, 4}})
    ->ArgsProduct({{256}, {1, 2}, {3}})
    ->ArgNames({"size", "threads", "digits"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// `iterations` steps of the explicit scheme, start and copies included.
void explicit_scheme(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0)), iterations = size > 100 ? 10 : 100;
  const Image map = border_map(size);
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  for (auto _ : state)
    benchmark::DoNotOptimize(
        flow_field(map, Gvf{.mu = mu_of(size), .iterations = iterations, .scheme = GvfScheme::metric}));
  state.counters["iterations"] = iterations;
}
BENCHMARK(explicit_scheme)
    ->ArgsProduct({{64, 62, 128}, {1, 2}})
    ->ArgNames({"size", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// The sixteen border maps of a heart with eight gates, one field per thread.
void sixteen_fields(benchmark::State& state) {
  const Image map = border_map(64);
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  std::vector<SteadyWorkspace> workspaces(16);
  std::vector<FlowResult> results(16);
  for (auto _ : state)
    parallel_for(16, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) flow_field(map, SteadyGvf{.mu = 0.15}, workspaces[i], results[i]);
    });
}
BENCHMARK(sixteen_fields)->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dynasurf
