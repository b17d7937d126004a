#include "dynasurf/ventricle/detail/surface.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>

namespace dynasurf::ventricle {
namespace {

void note_repair(const mesh::Repair& repair, Notes& notes) {
  std::array<char, 200> text{};
  if (repair.untangled.left > 0) {
    std::snprintf(text.data(), text.size(), "the surface cuts itself in %zu places that smoothing did not free",
                  repair.untangled.left);
    notes.push_back({Severity::warning, "surface.tangled", text.data()});
  } else if (repair.untangled.found > 0) {
    std::snprintf(text.data(), text.size(),
                  "the surface cut itself; %zu vertices were moved by up to %.2f mm, its volume changed by %.2f mL",
                  repair.untangled.vertices_moved, repair.untangled.largest_move_mm,
                  repair.untangled.volume_change_mm3 / 1000);
    notes.push_back({Severity::info, "surface.untangled", text.data()});
  }
}

mesh::MoveReport sum_of(const mesh::MoveReport& a, const mesh::MoveReport& b) {
  return {a.vertices_moved + b.vertices_moved, std::max(a.largest_move_mm, b.largest_move_mm),
          a.volume_change_mm3 + b.volume_change_mm3};
}

void measure_distances(const TriMesh& mesh, const Image& border, Surface& s) {
  const double count = mesh.vertices.size();
  const std::vector<double> voxels = mesh::distances_to_border_voxels(mesh, border);
  s.within_one_voxel = std::count_if(voxels.begin(), voxels.end(), [](double d) { return d < 1; }) / count;
  s.border_reached = mesh::share_of_border_reached(mesh, border);
  const std::vector<double> mm = mesh::distances_to_border_mm(mesh, border);
  s.mean_distance_mm = std::accumulate(mm.begin(), mm.end(), 0.0) / count;
}

std::optional<Motion> motion_of(const dynamics::EvolutionResult& evolved, const Image& border) {
  if (evolved.trajectory.empty()) return std::nullopt;
  const Grid& grid = border.grid;
  Motion motion{to_world(grid, evolved.mesh).triangles, evolved.trajectory, {}, border, {}, {}};
  for (dynamics::TrajectoryStep& step : motion.steps) {
    motion.distances.push_back(mesh::signed_distances_to_border_voxels({step.places, evolved.mesh.triangles}, border));
    for (Vec3& p : step.places) p = to_world(grid, p);
    // Forces are turned to the world, not moved.
    for (Vec3& pull : step.pulls) pull = grid.direction * pull;
  }
  return motion;
}

}  // namespace

Surface measure_surface(const dynamics::EvolutionResult& evolved, const Image& border,
                        const std::optional<heart::BasePlane>& base_plane, const mesh::Tidy& options,
                        const TriMesh* settled) {
  Surface s;
  s.stop_reason = evolved.reason;
  s.steps = evolved.steps;
  s.step_s = evolved.step_s;
  s.step_explained = evolved.step_explained;
  s.stopped_fraction = evolved.stopped_fraction;
  measure_distances(evolved.mesh, border, s);
  TriMesh mesh = settled != nullptr ? *settled : evolved.mesh;
  mesh::MoveReport before_cut;
  if (base_plane) {
    before_cut = mesh::tidy(mesh, options);
    mesh = heart::flatten_above(std::move(mesh), to_grid(border.grid, *base_plane));
  }
  // Repaired and certified as it is published: rounding on the way to the world may make triangles meet.
  s.mesh = to_world(border.grid, std::move(mesh));
  s.repair = mesh::repair_surface(s.mesh, options);
  s.repair.tidied = sum_of(before_cut, s.repair.tidied);
  note_repair(s.repair, s.notes);
  s.volume_ml = mesh::volume_mm3(s.mesh) / 1000;
  s.quality = mesh::triangle_quality(s.mesh);
  s.motion = motion_of(evolved, border);
  return s;
}

}  // namespace dynasurf::ventricle
