// make_sample_clouds FOLDER: results and reports of clouds made by hand, one folder per kind, for the tests of the
// pages.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "dynasurf/cloud/detail/support.hpp"
#include "dynasurf/cloud/detail/transfer.hpp"
#include "dynasurf/mesh/detail/sample_surface.hpp"
#include "dynasurf/mesh/detail/submesh.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/report/detail/lod_page.hpp"
#include "dynasurf/report/report.hpp"

namespace {

using namespace dynasurf;

/// An egg that looks different from every side, as a surface of any fineness.
TriMesh egg(int level) {
  TriMesh mesh = mesh::icosphere(level);
  for (Vec3& p : mesh.vertices)
    p = Vec3(p[0], 1.4 * p[1], 0.8 * p[2]) * (1 + 0.25 * std::exp(3 * (p[0] - 1))) + Vec3(10, 20, 30);
  return mesh;
}

/// With `half` the side of small x is not scanned.
report::CloudRun run_of(std::initializer_list<int> levels, bool colours, bool half = false) {
  report::CloudRun run;
  const TriMesh fine = egg(5);
  PointCloud& cloud = run.result.used;
  for (const mesh::SurfaceSample& p : mesh::sample_surface(fine, 6000)) {
    if (half && mesh::position_of(fine, p)[0] < 10) continue;
    cloud.points.push_back(mesh::position_of(fine, p));
    if (colours) cloud.colours.push_back({static_cast<std::uint8_t>(cloud.points.back()[0] > 10 ? 220 : 40), 80, 60});
  }
  run.sources.push_back({"PLY", cloud.points.size(), 0});
  cloud::Facts& facts = run.result.facts;
  facts.points = facts.points_used = cloud.points.size();
  facts.spacing = 0.05;
  facts.cells = 64;
  facts.parts = 1;
  for (const int level : levels) {
    cloud::Level made;
    made.mesh = egg(level);
    made.triangles_asked = static_cast<int>(made.mesh.triangles.size());
    run.result.levels.push_back(std::move(made));
  }
  const cloud::KdTree neighbours(cloud.points);
  for (cloud::Level& level : run.result.levels) {
    cloud::Comparison comparison = cloud::compare(level.mesh, neighbours);
    level.certificate = comparison.certificate;
    level.errors = std::move(comparison.errors);
    level.confidence = cloud::confidences(level.mesh, {cloud.points, neighbours, facts});
    level.colours = cloud::colours_at_vertices(level.mesh, cloud, neighbours);
  }
  if (!run.result.levels.empty()) facts.diagonal = run.result.levels[0].certificate.cloud_diagonal;
  if (!run.result.levels.empty()) {
    cloud::measure_support(run.result.levels, {cloud.points, neighbours, facts}, run.result.support);
    run.result.notes = cloud::doubts_of(run.result.support, false);
  }
  run.result.notes.push_back({Severity::info, "cloud.noise", "the points are clean"});
  run.seconds = {{"read", 0.01}, {"levels", 0.5}};
  return run;
}

/// Half an egg, as an open surface.
report::CloudRun open_run() {
  report::CloudRun run = run_of({4, 3}, false, true);
  const cloud::KdTree neighbours(run.result.used.points);
  run.result.facts.boundary = cloud::BoundaryRule::keep;
  run.result.facts.boundary_loops = 1;
  run.result.notes.clear();
  for (cloud::Level& level : run.result.levels) {
    TriMesh& mesh = level.mesh;
    std::erase_if(mesh.triangles, [&](const auto& t) {
      return mesh.vertices[t[0]][0] + mesh.vertices[t[1]][0] + mesh.vertices[t[2]][0] < 3 * 10.1;
    });
    mesh = mesh::submesh(mesh, std::vector<std::uint8_t>(mesh.triangles.size(), 1));
    cloud::Comparison comparison = cloud::compare(mesh, neighbours);
    level.certificate = comparison.certificate;
    level.errors = std::move(comparison.errors);
    level.confidence.assign(mesh.vertices.size(), 1);
    level.colours.clear();
  }
  return run;
}

report::Provenance provenance() {
  report::Provenance p;
  p.program_version = "0.1.0";
  p.commit = "0123456789ab";
  p.command = "dynasurf cloud CLOUD --out RESULT --preset shaped";
  p.inputs.push_back({"input-1.ply", std::string(64, 'a'), 1234});
  p.options_json = R"({"method": "shaped", "triangles": "5120,1280,320"})";
  return p;
}

void write_sample(const std::filesystem::path& folder, const report::CloudRun& run) {
  std::filesystem::create_directories(folder);
  std::ofstream file(folder / "results.json", std::ios::binary);
  file << report::cloud_results_json(run, provenance()).dump(2) << "\n";
  if (!file.flush()) throw std::runtime_error("cannot write " + folder.string());
  report::write_cloud_report(run, provenance(), folder / "report.html");
}

void write_instances(int count, const std::filesystem::path& path) {
  const std::vector<TriMesh> levels{egg(4), egg(3), egg(2)};
  const std::vector<cloud::LodTransition> transitions{cloud::lod_transition(levels[1], levels[0]),
                                                      cloud::lod_transition(levels[2], levels[1])};
  report::LodPage options;
  options.instances = count;
  report::write_lod_page(levels, transitions, options, path);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: make_sample_clouds FOLDER\n", stderr);
    return 1;
  }
  try {
    const std::filesystem::path folder = arguments[1];
    write_sample(folder / "results" / "ok", run_of({4, 3, 2}, true));
    write_sample(folder / "results" / "one", run_of({3}, false));
    write_sample(folder / "results" / "half", run_of({4, 3}, false, true));
    write_sample(folder / "results" / "open", open_run());
    report::CloudRun broken = run_of({3, 2}, false);
    TriMesh& mesh = broken.result.levels[1].mesh;
    mesh.triangles.pop_back();
    broken.result.levels[1].certificate = cloud::certify(mesh, broken.result.used);
    write_sample(folder / "results" / "broken", broken);
    write_sample(folder / "results" / "empty", run_of({}, false));
    write_instances(200, folder / "instances.html");
    write_instances(1, folder / "instance.html");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_sample_clouds: %s\n", error.what());
    return 2;
  }
  return 0;
}
