// Prints the tables of README.md: how near each model comes to the border of the Hebron phantom, and how it swings.
#include <cmath>
#include <cstdio>
#include <vector>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/mesh/shapes.hpp"

#include "../support/hebron.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;

namespace {

constexpr int level = 3;  // 642 vertices

/// Root mean square distance to the border, voxels.
double rms_voxels(const TriMesh& mesh) {
  double sum = 0;
  const std::vector<double> away = distances_to_border_voxels(mesh, outer_border());
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

Late late(Evolution how) {
  how.smooth_after.sweeps = 0;
  how.histories = true;
  how.end.still_share = 1;
  how.end.still_radius = 0;  // who swings is not at rest
  // A force that only looks: it is asked at every stage of every step.
  std::vector<double> speeds;
  Additions look;
  look.forces.push_back({"look", [&speeds](const ParticleState& s, std::span<Vec3>) {
                           double sum = 0;
                           for (const Vec3& v : s.velocities) sum += v.norm();
                           speeds.push_back(sum / static_cast<double>(s.velocities.size()));
                         }});
  const EvolutionResult r = evolve(place(icosphere(level), outer_border(), {}), field_of(outer_border()),
                                   outer_border(), how, {}, nullptr, look);
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

void print(const char* name, const char* stop, const Late& r, const char* published) {
  std::printf("| %s | %s | %d | %.1f | %.1f to %.1f | %.2f | %.3f | %s |\n", name, stop, r.steps, r.near_percent,
              r.least, r.most, r.rms_voxels, r.speed_mm_s, published);
}

Evolution table_41(ModelOptions model, SolverOptions solver, double step_s) {
  Evolution how;
  how.model = model;
  how.solver = solver;
  how.step_s = step_s;
  how.mass_kg = 642;  // E38: with 1 kg in all, an explicit step of 0.05 s is three times too long
  how.force = {.strength = 25, .drag = 0.25};
  how.smooth_every = std::holds_alternative<FreeModel>(model) ? 1 : 0;
  return how;
}

constexpr const char* head =
    "| steps | < 1 voxel, % | from, to | rms, voxels | speed, mm/s | published |\n|---|---|---|---|---|---|---|---|\n";

void table_of_models() {
  std::printf("## Table 4.1\n\n642 vertices of 1 kg, strength 25, drag 0.25; the last of 60 s.\n\n| model | stop %s",
              head);
  struct Case {
    const char *name, *published;
    Evolution how;
  };
  const Case cases[] = {{"plain, dt 0.01", "77", table_41(PlainModel{}, BackwardEuler{}, 0.01)},
                        {"plain, dt 0.05", "74.5", table_41(PlainModel{}, BackwardEuler{}, 0.05)},
                        {"spring, dt 0.05", "73.6", table_41(SpringModel{}, Rk4{}, 0.05)},
                        {"free, dt 0.05", "97", table_41(FreeModel{}, Rk4{}, 0.05)}};
  for (const Case& c : cases)
    for (const bool stops : {false, true}) {
      Evolution how = c.how;
      how.stop.enabled = stops;
      how.end.max_steps = static_cast<int>(60 / how.step_s);
      print(c.name, stops ? "voxel" : "none", late(how), c.published);
    }
}

/// Particles of 1 kg in all, as the thesis says elsewhere: explicit solvers take the step that is stable.
void table_of_light_models() {
  std::printf("\n## Table 4.1 with 1 kg in all, stop at voxels\n\n| model | stop %s", head);
  struct Case {
    const char *name, *published;
    ModelOptions model;
    SolverOptions solver;
    double step_s;
    int steps;
  };
  const Case cases[] = {{"plain, dt 0.01", "77", PlainModel{}, BackwardEuler{}, 0.01, 3000},
                        {"plain, dt 0.05", "74.5", PlainModel{}, BackwardEuler{}, 0.05, 1200},
                        {"spring, stable dt", "73.6", SpringModel{}, Rk4{}, 0, 5000},
                        {"free, stable dt", "97", FreeModel{}, Rk4{}, 0, 5000}};
  for (const Case& c : cases) {
    Evolution how = table_41(c.model, c.solver, c.step_s);
    how.mass_kg = 1;
    how.end.max_steps = c.steps;
    print(c.name, "voxel", late(how), c.published);
  }
}

void oscillation() {
  std::printf("\n## Table 6.4: plain model, dt 0.05, no stop\n\n| test: stretch, shear, bend, strength | stop %s",
              head);
  struct Case {
    const char* name;
    double stretch, shear, bend, strength;
  };
  const Case cases[] = {{"A: 10, 0.5, 5, 50", 10, 0.5, 5, 50},
                        {"B: 10, 0.5, 10, 50", 10, 0.5, 10, 50},
                        {"C: 20, 0.5, 10, 50", 20, 0.5, 10, 50},
                        {"D: 10, 2, 10, 50", 10, 2, 10, 50},
                        {"E: 10, 0.5, 5, 1", 10, 0.5, 5, 1},
                        {"fig 6.11 left: 1, 0.1, 1, 25", 1, 0.1, 1, 25},
                        {"fig 6.11 right: 100, 1, 50, 25", 100, 1, 50, 25}};
  for (const Case& c : cases) {
    PlainModel plain{c.stretch, c.stretch / 10, c.shear, c.shear / 10, c.bend, c.bend / 10};
    Evolution how = plain_model();
    how.model = plain;
    how.step_s = 0.05;
    how.force = {.strength = c.strength, .drag = 0.1};
    how.stop.enabled = false;
    how.end.max_steps = 400;
    print(c.name, "none", late(how), c.name[0] == 'f' ? "left nearer to the data" : "goes on swinging");
  }
}

void smoothing() {
  std::printf(
      "\n## Table 4.3: smoothing on the way, 162 vertices, dt 0.1\n\n| solver | smoothing | steps until at rest | "
      "volume, "
      "mL |\n|---|---|---|---|\n");
  for (const bool on : {true, false})
    for (const auto& [name, solver] : {std::pair<const char*, SolverOptions>{"Euler", Euler{}}, {"RK4", Rk4{}}}) {
      Evolution how;
      how.solver = solver;
      how.step_s = 0.1;
      how.smooth_every = on ? 1 : 0;
      how.smooth_after.sweeps = 0;
      const EvolutionResult r =
          evolve(place(icosphere(2), outer_border(), {}), field_of(outer_border()), outer_border(), how);
      std::printf("| %s | %s | %d | %.1f |\n", name, on ? "on" : "off", r.steps, volume_mm3(r.mesh) / 1000);
    }
}

}  // namespace

int main() {
  std::printf("# Results\n\n");
  table_of_models();
  table_of_light_models();
  oscillation();
  smoothing();
}
