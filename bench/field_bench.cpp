// Gradient vector flow: the steady solver beside the explicit scheme, the bare memory and, where they are installed,
// ITK and hypre, in one run. docs/performance.md holds what it measured.
//
//     build/bench/bin/field_bench --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//
// The argument `threads` limits the loops. The column `CPU` is processor time over all threads, which other programs on
// a busy machine disturb least.
#include <algorithm>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/band.hpp"
#include "dynasurf/field/gvf.hpp"

#if DYNASURF_BENCH_HYPRE
#include "support/hypre_gvf.hpp"
#endif
#if DYNASURF_BENCH_ITK
#include <itkCovariantVector.h>
#include <itkGradientVectorFlowImageFilter.h>
#include <itkImage.h>
#include <itkMultiThreaderBase.h>
#endif

namespace dynasurf {
namespace {

/// A closed bumpy border one voxel thick. `size` 64 is a gated study, 64x64x23 at 2.87 x 2.87 x 5.74 mm; others are
/// cubes of 1 mm. A negative size -n is n x n x n/3 voxels of 1 x 1 x 3 mm.
Image border_map(int size) {
  Grid g;
  const int n = std::abs(size);
  g.dims = {n, n, size == 64 ? 23 : size < 0 ? n / 3 : n};
  if (size == 64) g.spacing = {2.87, 2.87, 5.74};
  if (size < 0) g.spacing = {1, 1, 3};
  const double width = n * g.spacing[0];
  const Vec3 centre = Vec3(g.dims[0] - 1, g.dims[1] - 1, g.dims[2] - 1).cwiseProduct(g.spacing) / 2;
  const auto inside = [&](int i, int j, int k) {
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

double per_voxel(std::size_t bytes, const Grid& g) {
  return static_cast<double>(bytes) / static_cast<double>(g.size());
}

/// size, threads, tolerance as a power of ten
void steady(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const Image map = border_map(size);
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  const field::SteadyGvf options{.mu = mu_of(size), .tolerance = std::pow(10.0, -static_cast<double>(state.range(2)))};
  field::SteadyWorkspace workspace;
  field::FlowResult result;
  for (auto _ : state) field::flow_field(map, options, workspace, result);
  state.counters["cycles"] = result.iterations;
  state.counters["error"] = *result.error;
  state.counters["bytes_per_voxel"] = per_voxel(workspace.bytes(), map.grid) + 16;  // map and result are 16
}
BENCHMARK(steady)
    ->ArgsProduct({{64, 62, 128}, {1, 2}, {2, 3, 4}})
    ->ArgsProduct({{256}, {1, 2}, {2, 3, 4}})
    ->ArgsProduct({{32, 96, -48, -96, -192}, {1}, {3}})
    ->ArgNames({"size", "threads", "digits"})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

/// size, floats of the widest vectors: 4 as with SSE2, 8 with AVX2, 16 with AVX-512, where the machine has them
void steady_in_vectors(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const Image map = border_map(size);
  const ThreadLimit limit(1);
  field::SteadyWorkspace workspace;
  field::FlowResult result;
  field::detail::widest_vectors = static_cast<int>(state.range(1));
  for (auto _ : state) field::flow_field(map, field::SteadyGvf{.mu = mu_of(size)}, workspace, result);
  field::detail::widest_vectors = 16;
}
BENCHMARK(steady_in_vectors)
    ->ArgsProduct({{64, 62, 128}, {4, 8, 16}})
    ->ArgNames({"size", "floats"})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

/// size, threads, reach; from the list of border voxels
void band(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const Image map = border_map(size);
  std::vector<Index3> border;
  for (int k = 0; k < map.grid.dims[2]; ++k)
    for (int j = 0; j < map.grid.dims[1]; ++j)
      for (int i = 0; i < map.grid.dims[0]; ++i)
        if (map(i, j, k) == 1) border.push_back({i, j, k});
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  const field::BandGvf options{.mu = mu_of(size), .reach_voxels = static_cast<int>(state.range(2))};
  double share = 0, bytes = 0;
  for (auto _ : state) {
    const field::BandResult r = field::band_field(map.grid, border, options);
    share = static_cast<double>(r.field.voxels_in_band()) / static_cast<double>(map.grid.size());
    bytes = per_voxel(r.field.bytes(), map.grid);
    state.counters["cycles"] = r.cycles;
  }
  state.counters["share_of_box"] = share;
  state.counters["border_voxels"] = static_cast<double>(border.size());
  state.counters["bytes_per_voxel"] = bytes;
}
BENCHMARK(band)
    ->ArgsProduct({{62, 128, 256}, {1, 2}, {3}})
    ->ArgNames({"size", "threads", "reach"})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

/// Steps of the explicit scheme, start and copies included: divide by the counter `steps`.
void explicit_steps(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0)), steps = size > 200 ? 10 : 40;
  const Image map = border_map(size);
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  for (auto _ : state)
    benchmark::DoNotOptimize(
        field::flow_field(map, field::Gvf{.mu = mu_of(size), .iterations = steps, .scheme = field::GvfScheme::metric}));
  state.counters["steps"] = steps;
}
BENCHMARK(explicit_steps)
    ->ArgsProduct({{64, 62, 128, 256}, {1, 2}})
    ->ArgNames({"size", "threads"})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

/// The least that any solver must do: read the map, write three components.
void stream_once(benchmark::State& state) {
  const Image map = border_map(static_cast<int>(state.range(0)));
  const std::size_t n = map.grid.size();
  field::VectorField field(map.grid);
  for (auto _ : state) {
    for (std::size_t v = 0; v < n; ++v) field.x[v] = field.y[v] = field.z[v] = map.values[v];
    benchmark::ClobberMemory();
  }
}
BENCHMARK(stream_once)
    ->Arg(64)
    ->Arg(62)
    ->Arg(128)
    ->Arg(256)
    ->ArgName("size")
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

/// The sixteen border maps of a heart with eight gates, one field per thread.
void sixteen_fields(benchmark::State& state) {
  const Image map = border_map(64);
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  std::vector<field::FlowResult> results(16);
  for (auto _ : state)
    parallel_for(16, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) results[i] = field::flow_field(map, field::SteadyGvf{.mu = 0.15});
    });
}
BENCHMARK(sixteen_fields)
    ->Arg(1)
    ->Arg(2)
    ->ArgName("threads")
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

#if DYNASURF_BENCH_HYPRE
/// |u - v| / |v| of one component.
double distance(const std::vector<double>& u, const std::vector<float>& v) {
  double apart = 0, size = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    apart += std::pow(u[i] - static_cast<double>(v[i]), 2);
    size += std::pow(static_cast<double>(v[i]), 2);
  }
  return std::sqrt(apart / size);
}

/// The three components to an error below 1e-3, set-up included, one thread. The residual to ask for is found before.
void hypre(benchmark::State& state) {
  static const test::MpiSession session;
  const int size = static_cast<int>(state.range(0));
  const Image map = border_map(size);
  const Vec3 rate = mu_of(size) * map.grid.spacing.cwiseAbs2().cwiseInverse();
  const field::VectorField exact = field::flow_field(map, field::SteadyGvf{.mu = mu_of(size), .tolerance = 1e-5}).field;
  double residual = 1e-2;
  while (distance(test::HypreGvf(map, rate, residual).component(0), exact.x) > 1e-3) residual /= 2;
  for (auto _ : state) {
    test::HypreGvf solver(map, rate, residual);
    for (std::size_t axis = 0; axis < 3; ++axis) benchmark::DoNotOptimize(solver.component(axis));
    state.counters["iterations"] = solver.iterations;
  }
  state.counters["residual"] = residual;
}
BENCHMARK(hypre)->Arg(64)->Arg(62)->Arg(128)->Arg(256)->ArgName("size")->UseRealTime()->MeasureProcessCPUTime()->Unit(
    benchmark::kMillisecond);
#endif

#if DYNASURF_BENCH_ITK
/// A few iterations of ITK's filter, which is the explicit scheme too.
void itk_steps(benchmark::State& state) {
  using Vector = itk::CovariantVector<float, 3>;
  using Vectors = itk::Image<Vector, 3>;
  const int size = static_cast<int>(state.range(0)), threads = static_cast<int>(state.range(1));
  const unsigned steps = size > 200 ? 2 : 5;
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(static_cast<itk::ThreadIdType>(threads));
  itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(static_cast<itk::ThreadIdType>(threads));
  const Image map = border_map(size);
  const field::VectorField start = field::flow_field(map, field::Gvf{.mu = mu_of(size), .iterations = 1}).field;
  auto input = Vectors::New();
  Vectors::SizeType extent;
  for (std::size_t a = 0; a < 3; ++a) extent[a] = static_cast<itk::SizeValueType>(map.grid.dims[a]);
  input->SetRegions(extent);
  input->Allocate();
  for (std::size_t v = 0; v < map.grid.size(); ++v) {
    Vector& to = input->GetBufferPointer()[v];
    to[0] = start.x[v], to[1] = start.y[v], to[2] = start.z[v];
  }
  for (auto _ : state) {
    auto filter = itk::GradientVectorFlowImageFilter<Vectors, Vectors, float>::New();
    filter->SetInput(input);
    filter->SetNoiseLevel(mu_of(size));
    filter->SetIterationNum(steps);
    filter->Update();
  }
  state.counters["steps"] = steps;
}
BENCHMARK(itk_steps)
    ->ArgsProduct({{64, 62, 128, 256}, {1, 2}})
    ->ArgNames({"size", "threads"})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace dynasurf
