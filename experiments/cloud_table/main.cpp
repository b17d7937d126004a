// Prints the tables of README.md: table 6.18 of the thesis, measured again with its recipe and with ours.
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"

#include "../support/surface_distance.hpp"

using namespace dynasurf;

namespace {

/// One level by itself, as the thesis timed it.
void print_row(const std::string& name, const PointCloud& cloud, const TriMesh& surface, const std::string& preset,
               int triangles) {
  cloud::Options options = cloud::preset(preset);
  options.triangles = {triangles};
  const std::clock_t start = std::clock();
  const cloud::Result result = cloud::reconstruct(cloud, options);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const cloud::Level& level = result.levels.at(0);
  const cloud::Certificate& c = level.certificate;
  std::printf(
      "| %s | %zu | %s | %zu | %.2f | %.2f | %s | %s | %zu | %.3f | %.3f | %.1f |\n", name.c_str(), cloud.points.size(),
      preset.c_str(), c.triangles, cloud::share_of_plain_tessellation_percent(c.triangles, cloud.points.size()),
      seconds, c.watertight() ? "yes" : "no", c.genus ? std::to_string(*c.genus).c_str() : "-", c.self_intersections,
      two_sided_percent(level.mesh, surface), 100 * c.cloud_to_mesh_largest / c.cloud_diagonal, c.smallest_angle_deg);
  std::fflush(stdout);
}

void print_rows(const std::string& name, const PointCloud& cloud, const TriMesh& surface) {
  for (const char* preset : {"thesis", "shaped", "faithful"})
    for (const int triangles : {320, 1280, 5120}) print_row(name, cloud, surface, preset, triangles);
}

/// Bodies built like the thesis's, with its counts of points.
void print_thesis_bodies() {
  using enum synthetic::CloudShape;
  for (const synthetic::CloudShape shape : {rabbit, screwdriver, vase, venus, moai, squirrel}) {
    PointCloud cloud = synthetic::make_cloud({.shape = shape, .points = 0});
    print_rows(std::string(word_of(shape)), cloud, synthetic::cloud_reference(shape));
  }
}

}  // namespace

int main(int argc, char** argv) try {
  std::printf(
      "| model | points | preset | triangles | of plain %% | cpu s | watertight | genus | crossings | distance %% | "
      "largest %% | angle |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  if (argc < 2) print_thesis_bodies();
  for (int i = 1; i < argc; ++i) {
    const std::filesystem::path path = argv[i];
    const TriMesh surface = io::read_mesh(path);
    PointCloud cloud;
    cloud.points = surface.vertices;
    print_rows(path.stem().string(), cloud, surface);
  }
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
