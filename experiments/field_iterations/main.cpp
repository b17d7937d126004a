// Prints the table of README.md: how far the explicit field is from that of 200 iterations, and from where it tends to.
#include <cmath>
#include <cstdio>
#include <ctime>

#include "dynasurf/field/gvf.hpp"

#include "../support/hebron.hpp"
#include "../support/run_file.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;

namespace {

double length(const field::VectorField& f, std::size_t v) { return std::hypot(f.x[v], f.y[v], f.z[v]); }

/// The thesis's "averaged relative error" (E56): the sum of the differences of the lengths, of the sum of the lengths.
double error_percent(const field::VectorField& field, const field::VectorField& of) {
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

void print(const RunFile& file) {
  std::printf(
      "| iterations | outer border, %% | inner border, %% | CPU, ms | published, %%; s | outer, %% of the field at "
      "rest "
      "|\n|---|---|---|---|---|---|\n");
  const std::vector<Row<field::Gvf>> rows = rows_of<field::Gvf>(file, "Table 6.12");
  if (rows.empty()) return;
  const auto field_of = [](const Image& border, const field::Gvf& options) {
    return field::flow_field(border, options).field;
  };
  // The first row is what the others are held against, as in the thesis.
  const field::VectorField outer = field_of(outer_border(), rows[0].options),
                           inner = field_of(inner_border(), rows[0].options);
  field::Gvf long_enough = rows[0].options;
  long_enough.iterations = 20000;
  const field::VectorField rest = field_of(outer_border(), long_enough);
  for (const Row<field::Gvf>& row : rows) {
    const double begin = cpu_s();
    const field::VectorField field = field_of(outer_border(), row.options);
    const double ms = 1e3 * (cpu_s() - begin);
    std::printf("| %s | %.1f | %.1f | %.1f | %s | %.1f |\n", row.name.c_str(), error_percent(field, outer),
                error_percent(field_of(inner_border(), row.options), inner), ms, row.published.c_str(),
                error_percent(field, rest));
  }
}

}  // namespace

int main(int count, char** arguments) { return run_tables(count, arguments, print); }
