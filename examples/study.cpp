// From a gated heart study to the ejection fraction and a folder with meshes, measures and a report.
// study STUDY RESULT

#include <cstdio>

#include "dynasurf/io/study_io.hpp"
#include "dynasurf/report/result_folders.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace ds = dynasurf;

int main(int argc, char** argv) {
  if (argc != 3) return 1;
  const ds::Study study = ds::io::read_study(argv[1]);
  const auto result = ds::ventricle::reconstruct(study, ds::ventricle::preset("psf_corrected"));
  if (const auto& ef = result.leading.ef_percent)
    std::printf("EF %.0f %% (%.0f-%.0f)\n", ef->value, ef->low(), ef->high());
  ds::report::write_study_folder(result, argv[2]);
}
