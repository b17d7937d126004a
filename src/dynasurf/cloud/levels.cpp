#include "dynasurf/cloud/detail/levels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/mesh/detail/relax.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/simplify.hpp"

namespace dynasurf::cloud {
namespace {

std::vector<Vec3> every(std::span<const Vec3> points, std::size_t step) {
  std::vector<Vec3> some;
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

/// Watching every collapse is slow where there are many, and seldom needed there: a surface that turns out to meet
/// itself is made again under watch.
void simplify_safely(mesh::SurfaceEditor& surface, const mesh::Simplify& options) {
  constexpr std::size_t many = 12000;
  if (surface.triangles() <= options.triangles) return;
  if (surface.triangles() <= many) {
    mesh::simplify(surface, options);
    return;
  }
  mesh::SurfaceEditor unwatched = surface;
  mesh::Simplify quick = options;
  quick.exact = false;
  mesh::simplify(unwatched, quick);
  if (mesh::self_intersections(unwatched.mesh()).free())
    surface = std::move(unwatched);
  else
    mesh::simplify(surface, options);
}

void collapse(mesh::SurfaceEditor& surface, std::size_t triangles, const LevelPlan& plan) {
  simplify_safely(surface,
                  {.triangles = triangles, .evenness = plan.evenness, .smallest_angle_deg = plan.collapse_angle_deg});
}

/// Few triangles find their places better from well-shaped ones half their size, and there it costs little.
constexpr std::size_t few = 640;

}  // namespace

void make_lighter(mesh::SurfaceEditor& surface, std::size_t triangles) {
  simplify_safely(surface, {.triangles = triangles, .evenness = 1e-3});
}

LevelPlan shaped_plan() { return {}; }

LevelPlan faithful_plan() {
  LevelPlan p;
  p.evenness = 1e-6;
  p.collapse_angle_deg = 8;
  p.largest_bend_deg = 15;
  p.rounds = 2;
  p.sweeps = 0;
  p.raise_deg = 7;
  p.hold_angle_deg = 5.5;
  p.smallest_angle_deg = 5.5;
  p.last_fits = 5;
  return p;
}

std::size_t step_of_fit(const LevelPlan& plan, std::size_t points, std::size_t triangles) {
  const double wanted = std::max(plan.points_per_triangle * triangles, plan.fewest_points);
  return std::max<std::size_t>(1, std::lround(points / wanted));
}

void lighten_for_level(mesh::SurfaceEditor& surface, std::size_t triangles, const LevelPlan& plan) {
  const TraceStage noted("levels: lighten");
  if (triangles > few) collapse(surface, triangles, plan);
}

std::size_t make_level(mesh::SurfaceEditor& surface, std::size_t triangles, const TriMesh& fine,
                       const mesh::ClosestPoint& on_fine, const FitPoints& points, const LevelPlan& plan) {
  if (triangles <= few && surface.triangles() > 3 * triangles)
    make_level(surface, 2 * triangles, fine, on_fine, points, plan);
  const TraceStage noted("levels: make");
  if (surface.triangles() < triangles) mesh::refine(surface, triangles + triangles / 2);
  collapse(surface, triangles, plan);
  const std::size_t step = step_of_fit(plan, points.points.size(), triangles);
  const std::vector<Vec3> some = every(points.points, step), normals = every(points.normals, step);
  FitOptions fitting{.rounds = 1,
                     .hold = plan.hold,
                     .smoothness = plan.smoothness,
                     .smallest_angle_deg = plan.hold_angle_deg,
                     .noise = plan.noise};
  for (int round = 0; round < plan.rounds; ++round) {
    const bool is_last = round == plan.rounds - 1;
    mesh::flip_to_larger_angles(surface, plan.largest_bend_deg);
    if (plan.sweeps > 0) {
      const std::vector<Vec3> safe(surface.positions().begin(), surface.positions().end());
      mesh::relax(surface, mesh::local_sizes(surface, 2), on_fine, fine, plan.sweeps, plan.raise_deg, plan.sharp_deg);
      mesh::revert_self_intersections(surface, safe);
    }
    if (is_last) {
      mesh::improve_smallest_angle(surface, plan.raise_deg, 8, plan.sharp_deg);
      fitting.rounds = plan.last_fits;
    }
    fit(surface, {some, normals}, fitting);
  }
  mesh::improve_smallest_angle(surface, plan.smallest_angle_deg, 10, plan.sharp_deg);
  return surface.triangles();
}

}  // namespace dynasurf::cloud
