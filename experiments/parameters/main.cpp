// Prints the tables of README.md: thesis tables 6.5, 6.6 and 6.7 again, on phantoms.
#include <cstdio>
#include <ctime>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/shapes.hpp"

#include "../support/hebron.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;

namespace {

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Evolution with(double strength, double drag, double step_s, int steps) {
  Evolution how;
  how.force = {.strength = strength, .drag = drag};
  how.step_s = step_s;
  how.end.max_steps = steps;
  how.smooth_after.sweeps = 0;
  return how;
}

void springs() {
  std::printf(
      "## Table 6.5: spring model, dt 0.00025, 2000 steps, 642 vertices, no stop\n\n| stiffness | damping | drag | "
      "strength | < 1 voxel, %% | published |\n|---|---|---|---|---|---|\n");
  const double rows[][5] = {{10, 1, 0.1, 10, 82.28},    {50, 1, 0.1, 10, 81.95},    {100, 1, 0.1, 10, 81.84},
                            {10, 1, 0.25, 10, 66.55},   {10, 1, 0.5, 10, 61.27},    {10, 1, 0.1, 100, 88.56},
                            {0.1, 0.01, 0.1, 1, 59.51}, {1000, 0, 0.25, 100, 88.77}};
  // Long enough to cover the way in half a second only where the start is near.
  const TriMesh start = place(icosphere(3), outer_border(), {.scale = 1.1});
  for (const auto& r : rows) {
    Evolution how = with(r[3], r[2], 0.00025, 2000);
    how.model = SpringModel{.stiffness = r[0], .damping = r[1], .rest_scale = 1 / 1.1};
    how.stop.enabled = false;
    how.smooth_every = 0;
    const TriMesh mesh = evolve(start, field_of(outer_border()), outer_border(), how).mesh;
    std::printf("| %g | %g | %g | %g | %.1f | %.1f |\n", r[0], r[1], r[2], r[3], near_percent(mesh, outer_border()),
                r[4]);
  }
}

void free_model_rows() {
  std::printf(
      "\n## Table 6.6: free model\n\nThe thesis names neither mesh nor data of a row: 642 vertices here.\n\n| row | "
      "drag | "
      "strength | dt | steps | taken | stopped, %% | < 1 voxel, %% | published "
      "|\n|---|---|---|---|---|---|---|---|---|\n");
  const double rows[][5] = {
      {0.1, 10, 0.00025, 2000, 87.12},   {0.1, 10, 0.1, 400, 92.36},      {0.1, 10, 0.01, 3400, 91.93},
      {0.1, 10, 0.01, 1000, 66.36},      {0.1, 10, 0.01, 200, 38.99},     {0.1, 10, 0.01, 400, 35.29},
      {0.1, 25, 0.0005, 7700, 100},      {0.1, 10, 0.005, 7200, 90.99},   {0.1, 25, 0.005, 3700, 90.35},
      {0.1, 10, 0.01, 3000, 93.13},      {0.1, 25, 0.0005, 15000, 90.05}, {0.25, 25, 0.001, 1800, 75.19},
      {0.25, 100, 0.00025, 2000, 36.41}, {0.1, 10, 0.005, 1900, 98.69},   {0.1, 10, 0.01, 900, 97.93},
      {0.1, 25, 0.005, 700, 98.02},      {0.25, 25, 0.01, 1000, 98.47},   {0.25, 25, 0.001, 1800, 77.57},
      {0.1, 10, 0.01, 3600, 91.18},      {0.1, 10, 0.1, 400, 92.36}};
  int n = 0;
  for (const auto& r : rows) {
    // A step of 0.1 s is above the limit of 642 particles; those rows can only be of the simple mesh.
    const int level = r[2] > 0.04 ? 2 : 3;
    const TriMesh start = place(icosphere(level), outer_border(), {});
    const EvolutionResult run =
        evolve(start, field_of(outer_border()), outer_border(), with(r[1], r[0], r[2], static_cast<int>(r[3])));
    std::printf("| %d%s | %g | %g | %g | %.0f | %d | %.1f | %.1f | %.1f |\n", ++n, level == 2 ? " (162)" : "", r[0],
                r[1], r[2], r[3], run.steps, 100 * run.stopped_fraction, near_percent(run.mesh, outer_border()), r[4]);
  }
}

void row(const char* name, const TriMesh& start, const Image& border, const Evolution& how, const char* published) {
  const double begin = cpu_s();
  const EvolutionResult r = evolve(start, field_of(border), border, how);
  const double took = cpu_s() - begin;
  const TriangleQuality q = triangle_quality(r.mesh);
  std::printf("| %s | %zu | %d | %.2f / %.2f | %.2f / %.2f | %.4f / %.4f | %.2f | %.1f | %s |\n", name,
              start.vertices.size(), r.steps, q.area_mean, q.d_mean, q.area_max, q.d_max, q.area_min, q.d_min, took,
              near_percent(r.mesh, border), published);
}

void qualities() {
  std::printf(
      "\n## Table 6.7: triangles and arrivals\n\n| run | vertices | steps | mean area / d | max | min | CPU, s | < 1 "
      "voxel, "
      "%% | published: mean; max; min; CPU; < 1 voxel |\n|---|---|---|---|---|---|---|---|---|\n");
  // Marching cubes over the doubled binary phantom of the Mayo Clinic.
  const Image doubled = double_resolution(make_phantom(Mayo{}).study.gates.front());
  static const Image mayo =
      threshold_at(doubled, 0.2 * *std::max_element(doubled.values.begin(), doubled.values.end()));
  static const Image border = external_border(mayo, 0.5);
  const TriMesh cubes = marching_cubes(mayo, 0.5);
  std::printf("| marching cubes before | %zu | 0 | %.2f | | | | %.1f | 10.50/1.46; 20.5/2.70; 0.25/0.33; -; 52.8 |\n",
              cubes.vertices.size(), triangle_quality(cubes).area_mean, near_percent(cubes, border));
  row("1 free", cubes, border, with(10, 0.1, 0.01, 1000), "9.44/1.34; 28.6/3; 0.043/0.024; 17.4; 71.4");
  Evolution how = with(100, 0.25, 0.00025, 1000);
  how.model = SpringModel{.stiffness = 1000, .damping = 0, .rest_scale = 1};
  how.smooth_every = 0;
  row("2 spring", cubes, border, how, "10.48/1.46; 20.4/2.67; 0.23/0.3; 267; 71.5");
  how = with(25, 0.1, 0.0005, 1000);
  how.model = RestrictedSpringModel{.stiffness = 1, .damping = 0, .rest_scale = 1};
  how.smooth_every = 0;
  row("3 restricted", cubes, border, how, "10.01/1.4; 23.1/2.7; 0.002/0.002; 449; 72.2");
  const auto sphere = [](int level) { return place(icosphere(level), outer_border(), {}); };
  row("5 free", sphere(3), outer_border(), with(25, 0.1, 0.0005, 20000), "22.9/2.6; 73.7/4.4; 0.7/0.07; 861; 90.1");
  row("6 free", sphere(3), outer_border(), with(10, 0.1, 0.005, 20000), "22.5/2.57; 116/5.23; 0.79/0.088; 485; 90.9");
  row("7 free", sphere(3), outer_border(), with(10, 0.1, 0.01, 20000), "22.5/2.57; 116/5.24; 0.82/0.09; 217; 91.2");
  row("8 free", sphere(4), outer_border(), with(25, 0.1, 0.005, 20000),
      "6.24/1.29; 72.4/4.95; 0.0007/0.0005; 514; 90.4");
  row("9 free", sphere(2), outer_border(), with(25, 0.25, 0.01, 20000), "84.0/5.1; 170/7.73; 23.2/1.99; 12.43; 93.1");
}

}  // namespace

int main() {
  std::printf("# Results\n\n");
  springs();
  free_model_rows();
  qualities();
}
