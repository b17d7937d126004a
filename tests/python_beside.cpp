// Reconstructs a study once for every line of standard input and prints the processor seconds it took: what the same
// call costs without Python. Usage: python_beside STUDY

#include <cstdio>
#include <ctime>
#include <iostream>
#include <string>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace {

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) return 1;
  const dynasurf::Study study = dynasurf::io::read_study(words[1]);
  const dynasurf::ventricle::Options options = dynasurf::ventricle::preset("psf_corrected");
  const dynasurf::ThreadLimit one(1);
  for (std::string line; std::getline(std::cin, line);) {
    const double begin = processor_seconds();
    const dynasurf::ventricle::Result result = dynasurf::ventricle::reconstruct(study, options);
    std::printf("%.6f %.6f\n", processor_seconds() - begin, result.leading.ef_percent->value);
    std::fflush(stdout);
  }
  return 0;
}
