#include "dynasurf/cloud/reconstruct_cloud.hpp"

#include "dynasurf/cloud/prepare.hpp"
#include "dynasurf/cloud/thesis_recipe.hpp"

namespace dynasurf {

CloudResult reconstruct_cloud(const PointCloud& cloud, const CloudOptions& options, const Progress& progress) {
  CloudOptions checked = options;
  check_options(checked, "cloud");
  const std::vector<int> triangles = parse_triangles(options.triangles);
  progress("points", 0, 1);
  PreparedCloud prepared = prepare(cloud, options, progress);
  progress("points", 1, 1);
  CloudResult result{{}, prepared.facts, std::move(prepared.cloud), std::move(prepared.notes)};
  std::vector<TriMesh> meshes = thesis_meshes(result.used.points, triangles, result.notes, progress);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    Certificate certificate = certify(meshes[i], result.used);
    result.levels.push_back({triangles[i], std::move(meshes[i]), certificate});
  }
  return result;
}

}  // namespace dynasurf
