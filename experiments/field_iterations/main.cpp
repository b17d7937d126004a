// Prints the table of README.md: how far the explicit field is from that of 200 iterations, and from where it tends to.
#include <cmath>
#include <cstdio>
#include <ctime>

#include "dynasurf/field/gvf.hpp"

#include "../support/hebron.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;

namespace {

double length(const VectorField& f, std::size_t v) { return std::hypot(f.x[v], f.y[v], f.z[v]); }

/// The thesis's "averaged relative error" (E56): the sum of the differences of the lengths, of the sum of the lengths.
double error_percent(const VectorField& field, const VectorField& of) {
  double difference = 0, sum = 0;
  for (std::size_t v = 0; v < field.x.size(); ++v) {
    difference += std::abs(length(field, v) - length(of, v));
    sum += length(of, v);
  }
  return 100 * difference / sum;
}

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Row {
  int iterations;
  double published_percent, published_s;
};

}  // namespace

int main() {
  const Row rows[] = {{200, 0, 30.334},   {150, 12, 21.119}, {100, 27.6, 14.49},
                      {75, 36.7, 10.795}, {50, 48.2, 7.34},  {25, 61.4, 3.414}};
  std::printf(
      "# Results\n\n| iterations | outer border, %% | inner border, %% | published, %% | CPU, ms | published, s | "
      "outer, %% "
      "of the field at rest |\n|---|---|---|---|---|---|---|\n");
  const auto field_after = [](const Image& border, int iterations) {
    return flow_field(border, Gvf{.mu = 2, .iterations = iterations}).field;
  };
  const VectorField outer = field_after(outer_border(), 200), inner = field_after(inner_border(), 200);
  const VectorField rest = field_after(outer_border(), 20000);
  for (const Row& row : rows) {
    const double begin = cpu_s();
    const VectorField field = field_after(outer_border(), row.iterations);
    const double ms = 1e3 * (cpu_s() - begin);
    std::printf("| %d | %.1f | %.1f | %.1f | %.1f | %.3f | %.1f |\n", row.iterations, error_percent(field, outer),
                error_percent(field_after(inner_border(), row.iterations), inner), row.published_percent, ms,
                row.published_s, error_percent(field, rest));
  }
}
