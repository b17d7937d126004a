// Prints the thesis's tables that no other experiment holds: 6.1 to 6.3, 6.8 to 6.11, 6.18 and single figures, as
// Markdown. experiment_thesis [--quick] [NAME=SURFACE...]: bodies of table 6.18 beside those that are built.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>

#include "dynasurf/cloud/detail/thesis_recipe.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/detail/voxel_truth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

#include "../support/hebron.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;

namespace {

/// Processor time: one thread runs, and a machine that is busy otherwise counts little.
double seconds_since(std::clock_t begin) { return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC; }

Image normalised(const Image& image) {
  Notes notes;
  return image::normalise(image, notes);
}

double largest_gradient(const Image& f) {
  const field::VectorField none = field::flow_field(f, field::Gvf{.mu = 1e-6, .iterations = 1}).field;
  return field::FieldView(none).largest();
}

/// Whether explicit flow ends finite and below 1.5 times the steepest gradient; the thesis looked at its vectors.
bool converges(const Image& f, double mu, double divisor, int iterations) {
  const field::FlowResult r =
      field::flow_field(f, field::Gvf{.mu = mu, .iterations = iterations, .step_divisor = divisor, .safe_step = false});
  return !r.diverged && field::FieldView(r.field).largest() <= 1.5 * largest_gradient(f);
}

/// The relative difference of two fields' lengths, as table 6.12 has it: a ratio of sums, per cent.
double difference(const field::VectorField& a, const field::VectorField& reference) {
  double sum = 0, all = 0;
  for (std::size_t n = 0; n < a.x.size(); ++n) {
    const double ours = Vec3(a.x[n], a.y[n], a.z[n]).norm();
    const double theirs = Vec3(reference.x[n], reference.y[n], reference.z[n]).norm();
    sum += std::abs(ours - theirs), all += theirs;
  }
  return all > 0 ? 100 * sum / all : 0;
}

void table_6_1() {
  std::printf(
      "\n## Table 6.1\n\nHebron, grey, mu 0.15, step divisor 16. Published: well defined from 50 iterations on, "
      "doubled "
      "data no better and no worse.\n\n| data | iterations | stable | change until twice as many, %% "
      "|\n|---|---|---|---|\n");
  const Image grey = normalised(hebron());
  const Image doubled = normalised(image::double_resolution(hebron()));
  for (const auto& [name, data] : {std::pair<const char*, const Image&>{"as acquired", grey}, {"doubled", doubled}})
    for (const int iterations : {25, 50, 100}) {
      const field::Gvf options{.mu = 0.15, .iterations = iterations};
      const field::FlowResult now = field::flow_field(data, options);
      const field::FlowResult later = field::flow_field(data, field::Gvf{.mu = 0.15, .iterations = 2 * iterations});
      std::printf("| %s | %d | %s | %.1f |\n", name, iterations, now.diverged ? "no" : "yes",
                  difference(now.field, later.field));
    }
}

void tables_6_2_and_6_3() {
  std::printf(
      "\n## Tables 6.2 and 6.3\n\n| phantom | iterations | step divisor | mu | found | published "
      "|\n|---|---|---|---|---|---|\n");
  const Image grey = normalised(hebron());
  for (const double divisor : {8.0, 16.0})
    for (const double mu : {0.01, 0.15, 0.5, 0.9})
      std::printf("| Hebron | 100 | %.0f | %.2f | %s | %s |\n", divisor, mu,
                  converges(grey, mu, divisor, 100) ? "converges" : "diverges", mu < 0.1 ? "diverges" : "converges");
  const Image mayo = normalised(synthetic::make_phantom(synthetic::Mayo{}).study.gates.front());
  for (const double divisor : {8.0, 16.0})
    std::printf("| Mayo | 50 | %.0f | 0.15 | %s | %s |\n", divisor,
                converges(mayo, 0.15, divisor, 50) ? "converges" : "diverges", divisor < 10 ? "diverges" : "converges");
}

struct Fit {
  double volume_mm3 = 0, seconds = 0, reached = 0;
  int steps = 0;
};

Fit fit(const Image& border, const field::VectorField& field, int level, const mesh::Placement& placement,
        double step_s, const dynamics::SolverOptions& solver, bool smoothed = true) {
  dynamics::Evolution evolution = dynamics::free_model();
  if (!smoothed) evolution.smooth_every = 0, evolution.smooth_after.sweeps = 0;
  evolution.solver = solver;
  evolution.step_s = step_s;
  const TriMesh start = mesh::start_mesh(border, level, placement);
  const auto begin = std::clock();
  const dynamics::EvolutionResult r = dynamics::evolve(start, field, border, evolution);
  const double seconds = seconds_since(begin);
  return {mesh::volume_mm3(r.mesh), seconds, mesh::share_of_border_reached(r.mesh, border), r.steps};
}

/// Closed by a cover, the volume of the voxels that the outer border encloses.
double covered_ml(const Image& border) {
  const Image solid = mesh::enclosed_solid(border);
  return static_cast<double>(std::count(solid.values.begin(), solid.values.end(), 1.f)) *
         border.grid.voxel_volume_mm3() / 1000;
}

void table_6_8() {
  const double data = 1000 * covered_ml(outer_border());
  std::printf(
      "\n## Table 6.8\n\nHebron, outer wall, free model, 162 vertices as published, and finer. The data hold %.0f mm3 "
      "(published 368782).\n\n| solver | vertices | dt, s | steps | CPU, s | volume, mm3 | of the data, %% | published "
      "|\n|---|---|---|---|---|---|---|---|\n",
      data);
  const field::VectorField& field = field_of(outer_border());
  const auto row = [&](const char* name, const dynamics::SolverOptions& solver, int level, double dt,
                       const char* published) {
    const Fit f = fit(outer_border(), field, level, {}, dt, solver);
    std::printf("| %s | %d | %g | %d | %.4f | %.0f | %+.2f | %s |\n", name,
                level == 2   ? 162
                : level == 3 ? 642
                             : 2562,
                dt, f.steps, f.seconds, f.volume_mm3, 100 * (f.volume_mm3 / data - 1), published);
  };
  row("Euler", dynamics::Euler{}, 2, 0.1, "363467, -1.44 %; 0.322 s");
  row("midpoint", dynamics::Midpoint{}, 2, 0.12, "366253, -0.68 %; 0.14 s");
  row("RK4", dynamics::Rk4{}, 2, 0.17, "363134, -1.53 %; 0.111 s");
  row("RK4", dynamics::Rk4{}, 3, 0.04, "");
  row("RK4", dynamics::Rk4{}, 4, 0.01, "");
}

/// What the thesis does not tell, one at a time, for the midpoint rule of table 6.8.
void table_6_8_causes() {
  const Image& border = outer_border();
  const field::VectorField& field = field_of(border);
  const double data = 1000 * covered_ml(border);
  std::printf(
      "\n## Table 6.8, causes\n\n162 vertices, midpoint, dt 0.12 as published, one choice at a time. Spheres with as "
      "many vertices lose 3.4 %% of their volume to their chords.\n\n| choice | volume, mm3 | of the data, %% "
      "|\n|---|---|---|\n");
  const auto row = [&](const char* name, const auto& change) {
    dynamics::Evolution evolution = dynamics::free_model();
    evolution.solver = dynamics::Midpoint{};
    evolution.step_s = 0.12;
    mesh::Placement placement;
    change(evolution, placement);
    const dynamics::EvolutionResult r =
        dynamics::evolve(mesh::start_mesh(border, 2, placement), field, border, evolution);
    const double volume = mesh::volume_mm3(r.mesh);
    std::printf("| %s | %.0f | %+.2f |\n", name, volume, 100 * (volume / data - 1));
  };
  using Evolution = dynamics::Evolution;
  using Place = mesh::Placement;
  row("as above", [](Evolution&, Place&) {});
  row("no smoothing at the end", [](Evolution& e, Place&) { e.smooth_after.sweeps = 0; });
  row("no smoothing at all", [](Evolution& e, Place&) { e.smooth_after.sweeps = 0, e.smooth_every = 0; });
  row("stop before the voxel, midpoint, dt 0.12 (published -0.68)",
      [](Evolution& e, Place&) { e.stop.point = dynamics::StopPoint::backtrack; });
  row("the same, no smoothing", [](Evolution& e, Place&) {
    e.stop.point = dynamics::StopPoint::backtrack;
    e.smooth_after.sweeps = 0, e.smooth_every = 0;
  });
  row("stop in the voxel's centre", [](Evolution& e, Place&) { e.stop.point = dynamics::StopPoint::centre; });
  const auto before = [&](const dynamics::SolverOptions& solver, double dt) {
    return [&solver, dt](Evolution& e, Place&) {
      e.stop.point = dynamics::StopPoint::backtrack, e.solver = solver, e.step_s = dt;
    };
  };
  const dynamics::SolverOptions euler = dynamics::Euler{}, rk4 = dynamics::Rk4{};
  row("stop before the voxel, Euler, dt 0.1 (published -1.44)", before(euler, 0.1));
  row("stop before the voxel, RK4, dt 0.17 (published -1.53)", before(rk4, 0.17));
  row("start 1.1 times the data", [](Evolution&, Place& p) { p.scale = 1.1; });
  row("start as a sphere", [](Evolution&, Place& p) { p.shape = mesh::StartShape::sphere; });
}

void table_6_9() {
  static const Image mayo = synthetic::make_phantom(synthetic::Mayo{}).study.gates.front();
  static const Image border = synthetic::external_border(mayo, 0.2, 33.55);
  const double data = 1000 * covered_ml(border);
  std::printf(
      "\n## Table 6.9\n\nMayo, outer wall, free model, dt 0.01, 162 vertices. The data hold %.0f mm3.\n\n| smoothing | "
      "steps | volume, mm3 | of the data, %% | published |\n|---|---|---|---|---|\n",
      data);
  for (const bool smoothed : {true, false}) {
    const Fit f = fit(border, field_of(border), 2, {}, 0.01, dynamics::Rk4{}, smoothed);
    std::printf("| %s | %d | %.0f | %+.2f | errors of 1.82 and 4.36 %% |\n", smoothed ? "on" : "off", f.steps,
                f.volume_mm3, 100 * (f.volume_mm3 / data - 1));
  }
}

/// The voxels outside the cavity that share a face with it: a particle that comes from inside stops where the cavity
/// ends. The border of the other tables is the outermost layer of the cavity itself, at whose inner faces it would
/// stop, a whole voxel early.
Image wall_around(const Mask& cavity) {
  Image wall(cavity.grid);
  const Index3& dims = cavity.grid.dims;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        if (cavity(i, j, k) != 0) continue;
        for (const Index3& d : {Index3{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
          if (cavity.grid.contains(i + d[0], j + d[1], k + d[2]) && cavity(i + d[0], j + d[1], k + d[2]) != 0)
            wall(i, j, k) = 1;
      }
  return wall;
}

void table_6_10() {
  static const Mask cavity = synthetic::enclosed_cavity(hebron());
  static const Image around = wall_around(cavity);
  const double data = 1000 * synthetic::voxel_volume_ml(cavity);
  std::printf(
      "\n## Table 6.10\n\nHebron, inner wall, free model. The data hold %.0f mm3 (published 42835.5).\n\n| from inside "
      "onto | start | vertices | size | volume, mm3 | of the data, %% | border reached, %% | published "
      "|\n|---|---|---|---|---|---|---|---|\n",
      data);
  const auto row = [&](const char* onto, const Image& border, const char* start, int level, double size,
                       const mesh::Placement& placement, const char* published) {
    const Fit f = fit(border, field_of(border), level, placement, 0.01, dynamics::Rk4{});
    std::printf("| %s | %s | %d | %g | %.0f | %+.1f | %.0f | %s |\n", onto, start, level == 2 ? 162 : 642, size,
                f.volume_mm3, 100 * (f.volume_mm3 / data - 1), 100 * f.reached, published);
  };
  const auto inside = [](mesh::StartShape shape, double size) {
    return mesh::Placement{.shape = shape, .direction = mesh::Direction::in_to_out, .inside_scale = size};
  };
  for (const int level : {2, 3})
    for (const double size : {0.3, 0.6, 0.9})
      row("the wall around the cavity", around, "along rays", level, size, inside(mesh::StartShape::radial, size),
          "39251.8, -8.36 %; 43259.9, +1.0 %");
  for (const double size : {0.6, 0.9})
    row("the wall around the cavity", around, "ellipsoid", 2, size, inside(mesh::StartShape::ellipsoid, size), "");
  row("the cavity's outermost voxels", inner_border(), "along rays", 2, 0.9, inside(mesh::StartShape::radial, 0.9), "");
  row("from outside, the cavity's outermost voxels", inner_border(), "ellipsoid", 3, 1.5, {}, "");
}

void table_6_11(bool quick) {
  std::printf(
      "\n## Table 6.11\n\nExplicit flow, mu 0.15, 200 iterations.\n\n| grid | CPU, s | published, s "
      "|\n|---|---|---|\n");
  const Image grey = normalised(hebron());
  const Image doubled = normalised(image::double_resolution(hebron()));
  double times[2] = {};
  int row = 0;
  for (const Image* data : {&grey, &doubled}) {
    double best = 1e300;
    for (int n = 0; n < (quick ? 1 : 3); ++n) {
      const auto begin = std::clock();
      field::flow_field(*data, field::Gvf{.mu = 0.15, .iterations = 200});
      best = std::min(best, seconds_since(begin));
    }
    times[row] = best;
    std::printf("| %d x %d x %d | %.3f | %s |\n", data->grid.dims[0], data->grid.dims[1], data->grid.dims[2], best,
                row == 0 ? "128.03" : "1247.6");
    ++row;
  }
  std::printf("| ratio | %.2f | 9.74 |\n", times[1] / times[0]);
}

/// A body of table 6.18, and what the thesis published of it.
struct Body {
  std::string name;
  std::vector<Vec3> points;
};

/// The rows of the table: name, points, seconds.
struct Published {
  const char* name;
  int points;
  const char* times;
};
constexpr Published published[] = {
    {"rabbit", 67038, "93.84 + - / 78.587 / 300.187"},  {"screwdriver", 27152, "96.93 + - / 89.097 / 201.381"},
    {"vase", 68097, "94.09 + - / 50.272 / 114.517"},    {"venus", 134345, "97.79 + - / 46.111 / 107.24"},
    {"moai", 10002, "94.52 + 1.332 / 26.456 / 57.277"}, {"squirrel", 9996, "93.64 + 1.343 / 7.548 / 69.001"}};

const char* published_times(const std::string& name) {
  for (const Published& row : published)
    if (name.starts_with(row.name)) return row.times;
  return "";
}

/// The fit of each mesh by itself, with its start outside the voxels, as the thesis timed it.
void table_6_18(const std::vector<Body>& bodies, bool quick) {
  std::printf(
      "\n## Table 6.18\n\n62^3 voxels, mu 2, 200 iterations; free model, RK4, K 0.1, dt 0.001; one thread. Arrived: "
      "particles in a voxel of the cloud. Published: field + fits of 320 / 1280 / 5120 triangles.\n\n| body | points | "
      "drag | triangles | field, s | fit, s | steps | arrived, %% | published, s |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const Body& body : bodies) {
    const cloud::CloudVoxels voxels = cloud::voxelise(body.points);
    const auto begin = std::clock();
    const field::VectorField field = field::flow_field(voxels.border, field::Gvf{.mu = 2, .iterations = 200}).field;
    const double field_s = seconds_since(begin);
    for (const double drag : {0.0, 0.1})
      for (const int level : {2, 3, 4}) {
        dynamics::Evolution evolution = dynamics::free_model();
        evolution.force = {.strength = 0.1, .drag = drag};
        evolution.step_s = 0.001;
        evolution.end.still_move = 0;
        evolution.end.max_steps = quick ? 5000 : 40000;
        evolution.smooth_every = 0, evolution.smooth_after.sweeps = 0;
        const TriMesh start = mesh::start_mesh(voxels.border, level, cloud::placement_of(cloud::CloudStart::ellipsoid));
        const auto fit_begin = std::clock();
        const dynamics::EvolutionResult r = dynamics::evolve(start, field, voxels.border, evolution);
        std::printf("| %s | %zu | %g | %zu | %.3f | %.3f | %d | %.1f | %s |\n", body.name.c_str(), body.points.size(),
                    drag, start.triangles.size(), field_s, seconds_since(fit_begin), r.steps, 100 * r.stopped_fraction,
                    published_times(body.name));
      }
  }
}

/// N23: what a step costs, and other single figures.
void single_figures() {
  const field::VectorField& field = field_of(outer_border());
  dynamics::Evolution evolution = dynamics::plain_model();
  evolution.force = {.strength = 25, .drag = 0.25};
  evolution.step_s = 0.05;
  evolution.stop.enabled = false;
  evolution.end.max_steps = 200;
  const TriMesh start = mesh::start_mesh(outer_border(), 3, {});
  const auto begin = std::clock();
  const dynamics::EvolutionResult r = dynamics::evolve(start, field, outer_border(), evolution);
  std::printf(
      "\n## Single figures\n\n| what | ours | published |\n|---|---|---|\n"
      "| a step of the plain model, 642 vertices, dt 0.05, K 25, drag 0.25 | %.4f s | 2.8474 s a frame (K7-600) |\n",
      seconds_since(begin) / std::max(1, r.steps));
}

std::vector<Body> bodies_of(int count, char** arguments) {
  std::vector<Body> bodies;
  // Those that the program builds, with as many points as the thesis had.
  const auto shapes = synthetic::names_of(synthetic::CloudShape{});
  for (const Published& row : published)
    for (std::size_t shape = 0; shape < shapes.size(); ++shape)
      if (shapes[shape] == row.name)
        bodies.push_back({std::string(row.name) + ", built",
                          synthetic::make_cloud({static_cast<synthetic::CloudShape>(shape), row.points}).points});
  for (int n = 1; n < count; ++n) {
    const std::string argument = arguments[n];
    if (const auto equal = argument.find('='); equal != std::string::npos)
      bodies.push_back({argument.substr(0, equal), io::read_mesh(argument.substr(equal + 1)).vertices});
  }
  return bodies;
}

}  // namespace

int main(int count, char** arguments) {
  const bool quick = count > 1 && std::strcmp(arguments[1], "--quick") == 0;
  const ThreadLimit limit(1);
  std::printf("# Tables of chapter 6\n");
  table_6_1();
  tables_6_2_and_6_3();
  table_6_8();
  table_6_8_causes();
  table_6_9();
  table_6_10();
  table_6_11(quick);
  table_6_18(bodies_of(count, arguments), quick);
  single_figures();
  return 0;
}
