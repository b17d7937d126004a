#include "cloud_run.hpp"

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "dynasurf/cloud/bake.hpp"
#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/cloud/orient.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/core/stage_clock.hpp"
#include "dynasurf/io/atomic_file.hpp"
#include "dynasurf/io/json_read.hpp"
#include "dynasurf/io/options_json.hpp"

#include "console.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Part of the screen's height down to which each level serves, for pictures 1080 pixels high.
std::vector<double> coverages_of(const std::vector<TriMesh>& meshes) {
  constexpr double screen_px = 1080;
  const LodChain chain = lod_chain(meshes);
  std::vector<double> coverages;
  for (std::size_t n = 1; n < meshes.size(); ++n) coverages.push_back(chain.largest_px[n] / screen_px);
  coverages.push_back(0);
  return coverages;
}

void write_levels(const CloudResult& result, const CloudJob& job, const fs::path& folder) {
  std::vector<LodSurface> levels;
  std::vector<TriMesh> meshes;
  for (std::size_t n = 0; n < result.levels.size(); ++n) {
    const TriMesh& mesh = result.levels[n].mesh;
    if (mesh.triangles.empty()) continue;  // its certificate says so
    const VertexColours& colours = result.levels[n].colours;
    const std::string name = name_of_level(result, n);
    for (const MeshFormat format : job.mesh_formats)
      write_mesh(mesh, folder / "meshes" / (name + "." + std::string(word_of(format))), format, {}, colours);
    levels.push_back({name, mesh, colours, 0, {}});
    meshes.push_back(mesh);
  }
  if (levels.empty()) return;
  const std::vector<double> coverages = coverages_of(meshes);
  for (std::size_t n = 0; n < levels.size(); ++n) levels[n].smallest_coverage = coverages[n];
  write_lod_glb(levels, folder / "levels.glb");
  if (!job.textures) return;
  PointCloud points = result.used;
  points.normals = orient(result.used, true).normals;
  for (LodSurface& level : levels) level.textured = bake_textures(level.mesh, points);
  write_lod_glb(levels, folder / "textured.glb");
}

/// The most memory that this process has held; 0 where the system does not tell.
std::size_t peak_bytes() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::size_t>(usage.ru_maxrss) * 1024 : 0;
}

std::string results_text(const CloudRun& run, const Provenance& provenance, const CloudJob& job) {
  Json json = cloud_results_json(run, provenance, job.timings ? Timings::keep : Timings::omit);
  Json formats = Json::array();
  for (const MeshFormat format : job.mesh_formats) formats.push_back(word_of(format));
  json["provenance"]["outputs"] = {{"mesh_formats", formats}, {"textures", job.textures}};
  return json_text(json);
}

}  // namespace

CloudOutcome reconstruct_cloud_to_folder(const CloudJob& job, const Progress& progress) {
  const ThreadLimit limit(job.threads);
  std::vector<fs::path> inputs = job.clouds;
  if (!job.options_file.empty()) inputs.push_back(job.options_file);
  OutputFolder folder(job.out, job.existing, inputs);  // first: a place that cannot be written to costs no time
  CloudOutcome outcome;
  StageClock clock(outcome.run.seconds);
  const Progress timed{[&](std::string_view stage, int done, int total) {
                         clock.enter(stage);
                         progress(stage, done, total);
                       },
                       progress.stop};
  timed("read", 0, 1);
  CloudInput input = read_cloud(job.clouds);
  const Provenance provenance = provenance_of(job, job.clouds, options_to_text(job.options));
  progress.check();

  outcome.run.sources = std::move(input.sources);
  try {
    outcome.run.result = reconstruct_cloud(std::move(input.cloud), job.options, timed);
  } catch (const InputError& error) {  // the library knows the points, not the file they came from
    throw InputError(job.clouds.front().string() + ": " + error.what());
  }
  Notes& notes = outcome.run.result.notes;
  notes.insert(notes.begin(), input.notes.begin(), input.notes.end());
  progress.check();

  timed("write", 0, 1);
  parallel_for(2, 1, [&](std::size_t task, std::size_t) {
    if (task == 0) write_levels(outcome.run.result, job, folder.path());
    // The page tells no times, so that equal runs give equal pages.
    if (task == 1) write_cloud_report(outcome.run, provenance, folder.path() / "report.html", Timings::omit);
  });
  write_file(folder.path() / "options.json", provenance.options_json);
  write_file(folder.path() / "results.csv", cloud_results_csv(outcome.run.result));
  clock.stop();
  outcome.run.peak_bytes = peak_bytes();
  outcome.json = results_text(outcome.run, provenance, job);
  write_file(folder.path() / "results.json", outcome.json);
  progress.check();
  folder.publish();
  outcome.moved_to = folder.moved_to();
  return outcome;
}

std::string summary_of(const CloudRun& run) {
  const CloudResult& result = run.result;
  std::vector<std::vector<std::string>> rows{
      {"level", "triangles", "watertight", "parts", "genus", "smallest angle", "mean distance", "largest"}};
  for (std::size_t n = 0; n < result.levels.size(); ++n) {
    const Certificate& c = result.levels[n].certificate;
    const auto share = [&](double length) {
      return c.cloud_diagonal > 0 ? fixed(100 * length / c.cloud_diagonal, 3) + " %" : std::string("-");
    };
    rows.push_back({std::to_string(n + 1), std::to_string(c.triangles), c.watertight() ? "yes" : "no",
                    std::to_string(c.components), c.genus ? std::to_string(*c.genus) : "-",
                    fixed(c.smallest_angle_deg, 1) + " deg", share(c.cloud_to_mesh_mean),
                    share(c.cloud_to_mesh_largest)});
  }
  std::string text = table(rows);
  for (std::size_t n = 0; n < result.levels.size(); ++n) {
    const Certificate& c = result.levels[n].certificate;
    if (c.watertight()) continue;
    text += "level " + std::to_string(n + 1) + " is not watertight:";
    if (!c.closed) text += " not closed;";
    if (!c.manifold) text += " not manifold;";
    if (!c.oriented) text += " not oriented alike;";
    if (!c.outward) text += " turned inside out;";
    if (c.self_intersections > 0) text += " " + std::to_string(c.self_intersections) + " pairs of triangles meet;";
    if (c.flat_triangles > 0) text += " " + std::to_string(c.flat_triangles) + " flat triangles;";
    text.back() = '\n';
  }
  std::size_t remarks = 0;
  for (const Note& note : result.notes) {
    if (note.severity == Severity::info) ++remarks;
    if (note.severity != Severity::info) text += line_of(note) + "\n";
  }
  if (remarks > 0) text += std::to_string(remarks) + " remarks in results.json and report.html\n";
  return text;
}

}  // namespace dynasurf::app
