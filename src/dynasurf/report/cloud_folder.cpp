#include <nlohmann/json.hpp>

#include "dynasurf/cloud/detail/bake.hpp"
#include "dynasurf/cloud/detail/level_chain.hpp"
#include "dynasurf/cloud/detail/orient.hpp"
#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/report/result_folders.hpp"

namespace dynasurf::report {
namespace {

namespace fs = std::filesystem;

/// Part of the screen's height down to which each level serves, for pictures 1080 pixels high.
std::vector<double> coverages_of(const std::vector<TriMesh>& meshes) {
  constexpr double screen_px = 1080;
  const cloud::LodChain chain = cloud::lod_chain(meshes);
  std::vector<double> coverages;
  for (std::size_t n = 1; n < meshes.size(); ++n) coverages.push_back(chain.largest_px[n] / screen_px);
  coverages.push_back(0);
  return coverages;
}

void write_levels(const cloud::Result& result, const CloudFolderOptions& options, const fs::path& folder) {
  std::vector<io::LodSurface> levels;
  std::vector<TriMesh> meshes;
  for (std::size_t n = 0; n < result.levels.size(); ++n) {
    const TriMesh& mesh = result.levels[n].mesh;
    if (mesh.triangles.empty()) continue;  // its certificate says so
    const io::VertexColours& colours = result.levels[n].colours;
    const std::string name = name_of_level(result, n);
    std::vector<io::VertexScalar> scalars;
    if (!result.levels[n].confidence.empty()) scalars.push_back({"confidence", result.levels[n].confidence});
    for (const io::MeshFormat format : options.mesh_formats)
      io::write_mesh(mesh, folder / "meshes" / (name + "." + std::string(word_of(format))), format, scalars, colours);
    levels.push_back({name, mesh, colours, 0, {}, scalars});
    meshes.push_back(mesh);
  }
  if (levels.empty()) return;
  const std::vector<double> coverages = coverages_of(meshes);
  for (std::size_t n = 0; n < levels.size(); ++n) levels[n].smallest_coverage = coverages[n];
  io::write_lod_glb(levels, folder / "levels.glb");
  if (options.packed) io::write_packed_lod_glb(levels, folder / "packed.glb");
  if (!options.textures) return;
  PointCloud points = result.used;
  // A closed surface faces outwards, also where it was scanned from within.
  if (!cloud::is_open(result.facts)) points.scanners.clear();
  points.normals = cloud::orient(points, true).normals;
  for (io::LodSurface& level : levels) level.textured = cloud::bake_textures(level.mesh, points);
  io::write_lod_glb(levels, folder / "textured.glb");
}

}  // namespace

void write_cloud_files(const CloudRun& run, const Provenance& provenance, const CloudFolderOptions& options,
                       const fs::path& folder) {
  parallel_for_files(2, [&](std::size_t task) {
    if (task == 0) write_levels(run.result, options, folder);
    // The page tells no times, so that equal runs give equal pages.
    if (task == 1) write_cloud_report(run, provenance, folder / "report.html", Timings::omit);
  });
  if (!provenance.options_json.empty()) io::write_file(folder / "options.json", provenance.options_json);
  io::write_file(folder / "results.csv", cloud_results_csv(run.result));
}

void write_cloud_folder(const cloud::Result& result, const fs::path& out, const Provenance& provenance,
                        const CloudFolderOptions& options) {
  io::OutputFolder folder(out);
  CloudRun run;
  run.result = result;
  write_cloud_files(run, provenance, options, folder.path());
  io::write_file(folder.path() / "results.json", io::json_text(cloud_results_json(run, provenance, Timings::omit)));
  folder.publish();
}

}  // namespace dynasurf::report
