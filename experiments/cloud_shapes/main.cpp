// Prints the tables of README.md: bodies with known surfaces, scanned clean, noisy and torn, and what becomes of them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"

#include "../support/surface_distance.hpp"

using namespace dynasurf;

namespace {

struct Subject {
  std::string name;
  TriMesh surface;
  int genus;
};

struct Condition {
  std::string name;
  double noise_percent, missing_percent;
};

struct Row {
  bool is_valid = false;
  double distance = 0, smallest_angle = 0;
};

struct Arguments {
  int points = 100000, seeds = 1, handles = 0;
  std::string triangles = "5120,1280,320";
  std::vector<std::string> presets{"shaped", "faithful", "thesis"};
  std::vector<Condition> conditions{{"clean", 0, 0}, {"noise 0.5 %", 0.5, 0}, {"a fifth missing", 0, 20}};
  std::vector<std::string> shapes;
  std::vector<std::filesystem::path> meshes;
  std::filesystem::path assess;
};

/// What an independent program says of the mesh, one line of JSON.
void ask_judge(const Arguments& a, const TriMesh& mesh, const TriMesh& truth) {
  const auto folder = std::filesystem::temp_directory_path();
  const auto ours = folder / "cloud_shapes_mesh.off", reference = folder / "cloud_shapes_truth.off";
  io::write_mesh(mesh, ours, io::MeshFormat::off);
  io::write_mesh(truth, reference, io::MeshFormat::off);
  std::fflush(stdout);
  const std::string command = a.assess.string() + " " + ours.string() + " --ref " + reference.string();
  if (std::system(command.c_str()) != 0) std::printf("the judge failed\n");
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void run(const Arguments& a, const std::vector<Subject>& subjects, const std::string& preset,
         const Condition& condition) {
  std::printf(
      "\n## %s, %s\n\n| body | seed | parts | genus | triangles | valid | distance %% | cloud to mesh %% | largest %% "
      "| angle | "
      "1st percentile | cpu s |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      preset.c_str(), condition.name.c_str());
  std::map<int, std::vector<Row>, std::greater<>> all;
  for (const Subject& s : subjects)
    for (int seed = 1; seed <= a.seeds; ++seed) {
      const PointCloud cloud = synthetic::scan_surface(s.surface, {.points = a.points,
                                                                   .noise_percent = condition.noise_percent,
                                                                   .missing_percent = condition.missing_percent,
                                                                   .seed = static_cast<std::uint64_t>(seed)});
      cloud::Options options = cloud::preset(preset);
      set_option(options, "triangles=" + a.triangles);
      const std::clock_t start = std::clock();
      const cloud::Result result = cloud::reconstruct(cloud, options);
      const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      for (const cloud::Level& level : result.levels) {
        const cloud::Certificate& c = level.certificate;
        const bool is_valid = c.watertight() && c.components == 1 && c.genus == s.genus;
        const double distance = two_sided_percent(level.mesh, s.surface);
        all[level.triangles_asked].push_back({is_valid, distance, c.smallest_angle_deg});
        std::printf("| %s | %d | %d | %s | %zu | %s | %.4f | %.4f | %.3f | %.1f | %.1f | %.2f |\n", s.name.c_str(),
                    seed, c.components, c.genus ? std::to_string(*c.genus).c_str() : "-", c.triangles,
                    is_valid         ? "yes"
                    : c.watertight() ? "other kind"
                                     : "no",
                    distance, 100 * c.cloud_to_mesh_mean / c.cloud_diagonal,
                    100 * c.cloud_to_mesh_largest / c.cloud_diagonal, c.smallest_angle_deg, c.angle_percentile_1_deg,
                    seconds);
        if (!a.assess.empty()) ask_judge(a, level.mesh, s.surface);
      }
      std::fflush(stdout);
    }
  for (const auto& [triangles, rows] : all) {
    std::vector<double> distances, angles;
    std::size_t valid = 0;
    for (const Row& r : rows) {
      distances.push_back(r.distance);
      angles.push_back(r.smallest_angle);
      valid += r.is_valid;
    }
    std::printf("\n%d triangles: valid %zu of %zu, distance %.4f %% (worst %.4f), smallest angle %.1f (worst %.1f)\n",
                triangles, valid, rows.size(), median(distances), *std::max_element(distances.begin(), distances.end()),
                median(angles), *std::min_element(angles.begin(), angles.end()));
  }
  std::fflush(stdout);
}

std::vector<Subject> subjects_of(const Arguments& a) {
  std::vector<Subject> subjects;
  for (const auto& path : a.meshes) subjects.push_back({path.stem().string(), io::read_mesh(path), a.handles});
  if (!subjects.empty()) return subjects;
  for (std::size_t i = 0; i < synthetic::names_of(synthetic::CloudShape{}).size(); ++i) {
    const auto shape = static_cast<synthetic::CloudShape>(i);
    const std::string name(word_of(shape));
    if (a.shapes.empty() || std::find(a.shapes.begin(), a.shapes.end(), name) != a.shapes.end())
      subjects.push_back({name, synthetic::cloud_reference(shape), synthetic::genus_of(shape)});
  }
  return subjects;
}

std::optional<Arguments> read(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 == argc) return std::nullopt;
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--points")
      a.points = std::atoi(value.c_str());
    else if (name == "--seeds")
      a.seeds = std::atoi(value.c_str());
    else if (name == "--handles")
      a.handles = std::atoi(value.c_str());
    else if (name == "--triangles")
      a.triangles = value;
    else if (name == "--shape")
      a.shapes.push_back(value);
    else if (name == "--preset")
      a.presets = {value};
    else if (name == "--mesh")
      a.meshes.push_back(value);
    else if (name == "--judge")
      a.assess = value;
    else if (name == "--only")
      std::erase_if(a.conditions, [&](const Condition& c) { return c.name.find(value) == std::string::npos; });
    else
      return std::nullopt;
  }
  return a;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::optional<Arguments> arguments = read(argc, argv);
  if (!arguments) {
    std::fprintf(
        stderr,
        "usage: experiment_cloud_shapes [--points N] [--preset shaped|faithful|thesis] [--only clean|noise|"
        "missing] [--shape NAME]... [--mesh FILE]... [--handles N] [--seeds N] [--triangles LIST] [--judge PROGRAM]\n");
    return 1;
  }
  const std::vector<Subject> subjects = subjects_of(*arguments);
  for (const std::string& preset : arguments->presets)
    for (const Condition& condition : arguments->conditions) run(*arguments, subjects, preset, condition);
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
