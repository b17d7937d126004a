// The two-dimensional part of one study: eight gates of 64 x 64 x 23, edges to labels, and its parts one by one.
//
//     build/bench/bin/borders_bench --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//
// `study` is what a user waits for: edges, circle, labels and boxes of all gates, gates in parallel. The argument is
// the number of threads; the others run on one. Compass stands beside Canny of the same width: the ratio is what
// counts.
#include <benchmark/benchmark.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/edges.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/detail/canonical.hpp"
#include "dynasurf/ventricle/label_borders.hpp"

namespace dynasurf {
namespace {

/// A patient with gut and counts as they are in the clinic, normalised.
const Study& study() {
  static const Study made = [] {
    synthetic::VirtualPatient o;
    o.gates = 8, o.lattice = {64, 64, 23, 2.87, 2.87, 5.74};
    o.gut_amplitude = 0.8, o.right_ventricle = 0.3;
    return ventricle::canonical_study(synthetic::make_phantom(o).study);
  }();
  return made;
}

const std::vector<image::EdgeMap>& edge_maps() {
  static const std::vector<image::EdgeMap> made = [] {
    std::vector<image::EdgeMap> maps;
    for (const Image& gate : study().gates) maps.push_back(image::detect_edges(gate, image::Canny{}));
    return maps;
  }();
  return made;
}

void study_2d(benchmark::State& state) {
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  const Study& all = study();
  std::vector<ventricle::Labels> labels(all.gates.size());
  for (auto _ : state) {
    parallel_for(all.gates.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t g = begin; g < end; ++g)
        labels[g] = ventricle::label_borders(all.gates[g], image::detect_edges(all.gates[g], image::Canny{}), {});
    });
    benchmark::DoNotOptimize(labels.data());
  }
}
BENCHMARK(study_2d)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

template <class Options>
void edges(benchmark::State& state, Options options) {
  const ThreadLimit one(1);
  for (auto _ : state)
    for (const Image& gate : study().gates) benchmark::DoNotOptimize(image::detect_edges(gate, options));
}
BENCHMARK_CAPTURE(edges, canny_sigma_1, image::Canny{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(edges, canny_sigma_1_8, image::Canny{.sigma_px = 1.8})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(edges, canny_revised, image::CannyRevised{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(edges, gradient, image::GradientEdges{.thin = true})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(edges, sobel, image::SobelEdges{.thin = true})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(edges, acc, image::ContourCompletion{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(edges, compass_sigma_1, image::Compass{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(edges, compass_sigma_1_8, image::Compass{.sigma_px = 1.8})->Unit(benchmark::kMillisecond);

template <class Options>
void labels(benchmark::State& state, Options options) {
  const ThreadLimit one(1);
  ventricle::Labelling o;
  o.method = options;
  for (auto _ : state)
    for (std::size_t g = 0; g < study().gates.size(); ++g)
      benchmark::DoNotOptimize(ventricle::label_borders(study().gates[g], edge_maps()[g], o));
}
BENCHMARK_CAPTURE(labels, mlc, ventricle::Mlc{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(labels, mlc_strict_thesis, (ventricle::Mlc{.strict_thesis = true, .box_margin_px = 0}))
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(labels, radial, ventricle::RadialLabels{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(labels, case, ventricle::CaseLabels{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(labels, gradmag, ventricle::GradMagLabels{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(labels, sign, ventricle::SignLabels{})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(labels, none, ventricle::NoLabels{})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dynasurf
