// From a scanned cloud of points to closed meshes of 5120, 1280 and 320 triangles, with certificates and a report.
// scan CLOUD RESULT

#include <array>
#include <cstdio>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/report/result_folders.hpp"

namespace ds = dynasurf;

int main(int argc, char** argv) {
  if (argc != 3) return 1;
  const std::array<std::filesystem::path, 1> files{argv[1]};
  const auto result = ds::cloud::reconstruct(ds::io::read_cloud(files).cloud, ds::cloud::preset("shaped"));
  for (const auto& level : result.levels)
    std::printf("%zu triangles, %s\n", level.mesh.triangles.size(),
                level.certificate.watertight() ? "watertight" : "open");
  ds::report::write_cloud_folder(result, argv[2]);
}
