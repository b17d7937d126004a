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
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/synthetic/voxel_truth.hpp"

#include "../support/hebron.hpp"

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

void row(const std::string& name, const TriMesh& mesh, const Image& border) {
  const TriangleQuality q = triangle_quality(mesh);
  std::printf("| %s | %zu | %zu | %.2f / %.2f | %.2f / %.2f | %.4f / %.4f | %.3f | %.1f %% | %.1f |\n", name.c_str(),
              mesh.vertices.size(), mesh.triangles.size(), q.area_mean, q.d_mean, q.area_max, q.d_max, q.area_min,
              q.d_min, q.shape_min, near_percent(mesh, border), volume_mm3(mesh) / 1000);
}

TriMesh evolved(const TriMesh& start, const Image& border, const Evolution& how) {
  return evolve(start, field_of(border), border, how).mesh;
}

void before_and_after() {
  head("Tables 5.2 and 5.3: before and after, free model, outer wall", "mesh");
  for (const int level : {2, 3, 4}) {
    TriMesh mesh = place(icosphere(level), outer_border(), {});
    const std::string name = "mesh " + std::to_string(level - 1);
    row(name + " before", mesh, outer_border());
    mesh = evolved(mesh, outer_border(), {});
    row(name + " after", mesh, outer_border());
    tidy(mesh, {});
    row(name + " after and tidied", mesh, outer_border());
  }
}

void by_model() {
  head("Table 5.4: by model, 642 vertices", "model");
  const TriMesh start = place(icosphere(3), outer_border(), {});
  row("before", start, outer_border());
  for (const ModelOptions& model : {ModelOptions(SpringModel{}), ModelOptions(FreeModel{}),
                                    ModelOptions(RestrictedSpringModel{}), ModelOptions(PlainModel{})}) {
    Evolution how;
    how.model = model;
    how.end.max_steps = 4000;
    row(std::visit([](const auto& m) { return std::string(m.name); }, model), evolved(start, outer_border(), how),
        outer_border());
  }
}

void by_direction() {
  const Image& inner = inner_border();
  head("Table 5.5: outwards and inwards, free model, inner wall", "direction");
  for (const int level : {2, 3})
    for (const auto& [direction, scale] :
         {std::pair(Direction::out_to_in, 1.5), {Direction::in_to_out, 0.3}, {Direction::in_to_out, 0.6}}) {
      Placement placement;
      placement.direction = direction;
      placement.inside_scale = direction == Direction::in_to_out ? scale : placement.inside_scale;
      char name[40];
      std::snprintf(name, sizeof name, "%s from %.1f", word_of(direction).data(), scale);
      row(name, evolved(place(icosphere(level), inner, placement), inner, {}), inner);
    }
  std::printf("\nThe cavity of the data holds %.1f mL.\n", voxel_volume_ml(enclosed_cavity(hebron())));
}

void by_start() {
  head("Table 5.6: sphere and marching cubes as start, spring model, no stop, no smoothing", "start");
  for (const StartShape shape : {StartShape::ellipsoid, StartShape::marching_cubes}) {
    Placement placement;
    placement.shape = shape;
    const TriMesh start = start_mesh(outer_border(), 3, placement);
    Evolution how;
    SpringModel spring;
    if (shape == StartShape::marching_cubes) spring.rest_scale = 1;  // it is there already
    how.model = spring;
    how.stop.enabled = false;
    how.smooth_every = 0;
    how.smooth_after.sweeps = 0;
    how.step_s = 0.0005;
    how.end.max_steps = 4000;
    row(std::string(word_of(shape)) + " before", start, outer_border());
    row(std::string(word_of(shape)) + " after", evolved(start, outer_border(), how), outer_border());
  }
  std::printf(
      "\nThe grey phantom by marching cubes, without filling:\n\n| level | components | Euler | triangles | "
      "volume mL |\n|---|---|---|---|---|\n");
  const float max = *std::max_element(hebron().values.begin(), hebron().values.end());
  for (const double level : {0.2, 0.4, 0.5}) {
    const TriMesh mesh = marching_cubes(hebron(), level * max);
    const Topology t = topology(mesh);
    std::printf("| %.0f %% | %d | %ld | %zu | %.1f |\n", 100 * level, t.components, t.euler, t.triangles,
                volume_mm3(mesh) / 1000);
  }
}

void across_a_gap() {
  static const Image image = make_phantom(Gap{}).study.gates.front();
  static const Image border = external_border(image, 0.2, 35);
  const float max = *std::max_element(image.values.begin(), image.values.end());
  const Topology cubes = topology(marching_cubes(image, 0.5 * max));
  const TriMesh ours = evolved(place(icosphere(3), border, {}), border, {});
  std::printf(
      "\n## Fig 5.8: a phantom without its middle third\n\nMarching cubes gives %d components. The deformable "
      "surface is %d, of %.1f mL; of the whole phantom it is %.1f mL.\n",
      cubes.components, topology(ours).components, volume_mm3(ours) / 1000,
      volume_mm3(evolved(place(icosphere(3), outer_border(), {}), outer_border(), {})) / 1000);
}

}  // namespace

int main() {
  std::printf("# Results\n\nAreas in mm2, d = area / longest edge in mm. PH-HEBRON, default options of 0.1.0.\n");
  before_and_after();
  by_model();
  by_direction();
  by_start();
  across_a_gap();
}
