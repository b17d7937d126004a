// Prints the tables of README.md: how near each model comes to the border of the Hebron phantom, and how it swings.
#include <cmath>
#include <cstdio>
#include <vector>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/mesh/shapes.hpp"

#include "../support/hebron.hpp"
#include "../support/run_file.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;

namespace {

/// Root mean square distance to the border, voxels.
double rms_voxels(const TriMesh& mesh) {
  double sum = 0;
  const std::vector<double> away = mesh::distances_to_border_voxels(mesh, outer_border());
  for (const double d : away) sum += d * d;
  return std::sqrt(sum / static_cast<double>(away.size()));
}

/// The last tenth of a run.
struct Late {
  double near_percent = 0, least = 100, most = 0;  // share of particles within a voxel: mean and extremes
  double speed_mm_s = 0;                           // mean over the particles, and over time
  double rms_voxels = 0;                           // at the end
  int steps = 0;
};

Late late(const MeshRun& run) {
  // A force that only looks: it is asked at every stage of every step.
  std::vector<double> speeds;
  dynamics::Additions look;
  look.forces.push_back({"look", [&speeds](const dynamics::ParticleState& s, std::span<Vec3>) {
                           double sum = 0;
                           for (const Vec3& v : s.velocities) sum += v.norm();
                           speeds.push_back(sum / static_cast<double>(s.velocities.size()));
                         }});
  dynamics::Evolution evolution = run.evolution;
  evolution.histories = true;
  const dynamics::EvolutionResult r =
      dynamics::evolve(start_of(run, outer_border()), field_of(outer_border()), outer_border(), evolution, {}, look);
  Late result;
  result.steps = r.steps;
  result.rms_voxels = rms_voxels(r.mesh);
  const std::size_t first = r.histories.size() * 9 / 10;
  for (std::size_t n = first; n < r.histories.size(); ++n) {
    const double near = 100.0 * r.histories[n][0] / static_cast<double>(r.mesh.vertices.size());
    result.near_percent += near / static_cast<double>(r.histories.size() - first);
    result.least = std::min(result.least, near), result.most = std::max(result.most, near);
  }
  const std::size_t begin = speeds.size() * 9 / 10;
  for (std::size_t n = begin; n < speeds.size(); ++n)
    result.speed_mm_s += speeds[n] / static_cast<double>(speeds.size() - begin);
  return result;
}

void table(const RunFile& file, const std::string& title, const char* what) {
  std::printf(
      "## %s\n\n%s\n\n| run | steps | < 1 voxel, %% | from, to | rms, voxels | speed, mm/s | published "
      "|\n|---|---|---|---|---|---|---|\n",
      title.c_str(), what);
  for (const Row<MeshRun>& row : rows_of<MeshRun>(file, title)) {
    const Late r = late(row.options);
    std::printf("| %s | %d | %.1f | %.1f to %.1f | %.2f | %.3f | %s |\n", row.name.c_str(), r.steps, r.near_percent,
                r.least, r.most, r.rms_voxels, r.speed_mm_s, row.published.c_str());
    std::fflush(stdout);
  }
  std::printf("\n");
}

void smoothing(const RunFile& file) {
  std::printf(
      "## Table 4.3\n\nSmoothing on the way, 162 vertices, dt 0.1.\n\n| solver | steps until at rest | volume, mL "
      "|\n|---|---|---|\n");
  for (const Row<MeshRun>& row : rows_of<MeshRun>(file, "Table 4.3")) {
    const dynamics::EvolutionResult r = dynamics::evolve(
        start_of(row.options, outer_border()), field_of(outer_border()), outer_border(), row.options.evolution);
    std::printf("| %s | %d | %.1f |\n", row.name.c_str(), r.steps, mesh::volume_mm3(r.mesh) / 1000);
  }
}

void print(const RunFile& file) {
  table(file, "Table 4.1, 1 kg each", "642 vertices, strength 25, drag 0.25; the last tenth of 60 s.");
  table(file, "Table 4.1, 1 kg in all", "Stop at voxels; explicit solvers take the step that is stable.");
  table(file, "Lengths at rest",
        "As the first table, dt 0.05, stop at voxels. Lengths at rest as a share of those in a start 1.5 times as "
        "large as the data.");
  table(file, "Table 6.4", "Plain model, dt 0.05, no stop. The names tell stretch, shear, bend, strength.");
  smoothing(file);
}

}  // namespace

int main(int count, char** arguments) { return run_tables(count, arguments, print); }
