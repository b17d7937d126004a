// All labellers on one heart in many states: precision and recall per border, division slice, time.
#include <cstdio>

#include "dynasurf/core/parallel.hpp"

#include "study.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments::label_study;

int main() {
  const ThreadLimit one(1);
  std::printf(
      "%d seeds each; edges by Canny's defaults; hits within %.0f px of the true border; division: mean distance\n"
      "from the true division slice; ms: processor time, one thread. A blood pool has no outer border to be found.\n",
      seeds, tolerance_px);
  std::vector<double> sum(methods.size(), 0), without_pool(methods.size(), 0);
  const auto all = cases();
  for (const Case& c : all) {
    const Seen seen = see(c);
    std::printf("\n%-16s | endo prec  rec   F1 | epi prec  rec   F1 | division |  ms\n", c.name.c_str());
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const Result r = measure(seen.scenes, seen.edges, methods[m].options);
      sum[m] += r.mean_f1(c.has_outer_border) / static_cast<double>(all.size());
      if (c.name != "blood pool")
        without_pool[m] += r.mean_f1(c.has_outer_border) / static_cast<double>(all.size() - 1);
      std::printf("%-16s |     %5.2f %4.2f %4.2f |    ", methods[m].name.c_str(), r.endo.precision(), r.endo.recall(),
                  r.endo.f1());
      if (c.has_outer_border)
        std::printf("%5.2f %4.2f %4.2f", r.epi.precision(), r.epi.recall(), r.epi.f1());
      else
        std::printf("    -    -    -");
      std::printf(" |   %5.1f  | %4.0f\n", r.division, r.milliseconds);
    }
    std::fflush(stdout);
  }
  std::printf("\nMean F1 of both borders over all cases, and without the blood pool\n");
  for (std::size_t m = 0; m < methods.size(); ++m)
    std::printf("%-16s %.3f  %.3f\n", methods[m].name.c_str(), sum[m], without_pool[m]);
}
