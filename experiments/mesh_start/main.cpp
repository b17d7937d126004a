// Prints the tables of README.md: meshes before and after, by model, by direction, by start, and across a gap.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/detail/voxel_truth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

#include "../support/hebron.hpp"
#include "../support/run_file.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;

namespace {

void head(const char* title, const char* first) {
  std::printf(
      "\n## %s\n\n| %s | vertices | triangles | mean area / d | max area / d | min area / d | worst shape | < 1 voxel "
      "| "
      "volume mL |\n|---|---|---|---|---|---|---|---|---|\n",
      title, first);
}

void print_row(const std::string& name, const TriMesh& mesh, const Image& border) {
  const mesh::TriangleQuality q = mesh::triangle_quality(mesh);
  std::printf("| %s | %zu | %zu | %.2f / %.2f | %.2f / %.2f | %.4f / %.4f | %.3f | %.1f %% | %.1f |\n", name.c_str(),
              mesh.vertices.size(), mesh.triangles.size(), q.area_mean, q.d_mean, q.area_max, q.d_max, q.area_min,
              q.d_min, q.shape_min, near_percent(mesh, border), mesh::volume_mm3(mesh) / 1000);
}

TriMesh evolved(const MeshRun& run, const Image& border) {
  return dynamics::evolve(start_of(run, border), field_of(border), border, run.evolution).mesh;
}

void before_and_after(const RunFile& file) {
  head("Tables 5.2 and 5.3: before and after, free model, outer wall", "mesh");
  for (const Row<MeshRun>& row : rows_of<MeshRun>(file, "Tables 5.2 and 5.3")) {
    print_row(row.name + " before", start_of(row.options, outer_border()), outer_border());
    TriMesh mesh = evolved(row.options, outer_border());
    print_row(row.name + " after", mesh, outer_border());
    mesh::tidy(mesh, {});
    print_row(row.name + " after and tidied", mesh, outer_border());
  }
}

void by_model(const RunFile& file) {
  head("Table 5.4: by model, 642 vertices", "model");
  print_row("before", start_of({}, outer_border()), outer_border());
  for (const Row<MeshRun>& row : rows_of<MeshRun>(file, "Table 5.4"))
    print_row(row.name, evolved(row.options, outer_border()), outer_border());
}

void by_direction(const RunFile& file) {
  head("Table 5.5: outwards and inwards, free model, inner wall", "direction");
  for (const Row<MeshRun>& row : rows_of<MeshRun>(file, "Table 5.5"))
    print_row(row.name, evolved(row.options, inner_border()), inner_border());
  std::printf("\nThe cavity of the data holds %.1f mL.\n",
              synthetic::voxel_volume_ml(synthetic::enclosed_cavity(hebron())));
}

void by_start(const RunFile& file) {
  head("Table 5.6: sphere and marching cubes as start, spring model, no stop, no smoothing", "start");
  for (const Row<MeshRun>& row : rows_of<MeshRun>(file, "Table 5.6")) {
    print_row(row.name + " before", start_of(row.options, outer_border()), outer_border());
    print_row(row.name + " after (published " + row.published + ")", evolved(row.options, outer_border()),
              outer_border());
  }
  std::printf(
      "\nThe grey phantom by marching cubes, without filling:\n\n| level | components | Euler | triangles | "
      "volume mL |\n|---|---|---|---|---|\n");
  const float max = *std::max_element(hebron().values.begin(), hebron().values.end());
  for (const double level : {0.2, 0.4, 0.5}) {
    const TriMesh mesh = mesh::marching_cubes(hebron(), level * max);
    const mesh::Topology t = mesh::topology(mesh);
    std::printf("| %.0f %% | %d | %ld | %zu | %.1f |\n", 100 * level, t.components, t.euler, t.triangles,
                mesh::volume_mm3(mesh) / 1000);
  }
}

void across_a_gap(const RunFile& file) {
  static const Image image = synthetic::make_phantom(synthetic::Gap{}).study.gates.front();
  static const Image border = synthetic::external_border(image, 0.2, 35);
  const float max = *std::max_element(image.values.begin(), image.values.end());
  const mesh::Topology cubes = mesh::topology(mesh::marching_cubes(image, 0.5 * max));
  for (const Row<MeshRun>& row : rows_of<MeshRun>(file, "Fig 5.8")) {
    const TriMesh ours = evolved(row.options, border);
    std::printf(
        "\n## Fig 5.8: a phantom without its middle third\n\nMarching cubes gives %d components. The deformable "
        "surface (%s) is %d, of %.1f mL; of the whole phantom it is %.1f mL.\n",
        cubes.components, row.name.c_str(), mesh::topology(ours).components, mesh::volume_mm3(ours) / 1000,
        mesh::volume_mm3(evolved(row.options, outer_border())) / 1000);
  }
}

void print(const RunFile& file) {
  std::printf("Areas in mm2, d = area / longest edge in mm. PH-HEBRON, default options.\n");
  before_and_after(file);
  by_model(file);
  by_direction(file);
  by_start(file);
  across_a_gap(file);
}

}  // namespace

int main(int count, char** arguments) { return run_tables(count, arguments, print); }
