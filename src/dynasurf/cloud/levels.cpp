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

LevelMaker::LevelMaker(const TriMesh& fine, const mesh::ClosestPoint& on_fine, const FitPoints& points,
                       std::size_t triangles, const LevelPlan& plan)
    : fine_(fine), on_fine_(on_fine), points_(points), triangles_(triangles), plan_(plan) {
  const std::size_t step = step_of_fit(plan, points.points.size(), triangles);
  some_ = every(points.points, step);
  normals_ = every(points.normals, step);
}

void LevelMaker::begin(mesh::SurfaceEditor& surface) const {
  if (triangles_ <= few && surface.triangles() > 3 * triangles_)
    make_level(surface, 2 * triangles_, fine_, on_fine_, points_, plan_);
  const TraceStage noted("levels: begin");
  if (surface.triangles() < triangles_) mesh::refine(surface, triangles_ + triangles_ / 2);
  collapse(surface, triangles_, plan_);
  for (int round = 1; round < plan_.rounds; ++round) {
    shape(surface);
    fit(surface, {some_, normals_}, fitting(plan_.fits));
  }
}

void LevelMaker::finish(mesh::SurfaceEditor& surface) const {
  const TraceStage noted("levels: finish");
  shape(surface);
  mesh::improve_smallest_angle(surface, plan_.raise_deg, 8, plan_.sharp_deg);
  fit(surface, {some_, normals_}, fitting(plan_.last_fits));
  mesh::improve_smallest_angle(surface, plan_.smallest_angle_deg, 10, plan_.sharp_deg);
}

FitOptions LevelMaker::fitting(int rounds) const {
  return {.rounds = rounds,
          .hold = plan_.hold,
          .smoothness = plan_.smoothness,
          .smallest_angle_deg = plan_.hold_angle_deg,
          .noise = plan_.noise};
}

/// Better triangles in the same surface: flips, and moves within it.
void LevelMaker::shape(mesh::SurfaceEditor& surface) const {
  mesh::flip_to_larger_angles(surface, plan_.largest_bend_deg);
  if (plan_.sweeps == 0) return;
  const std::vector<Vec3> safe(surface.positions().begin(), surface.positions().end());
  mesh::relax(surface, mesh::local_sizes(surface, 2), on_fine_, fine_, plan_.sweeps, plan_.raise_deg, plan_.sharp_deg);
  mesh::revert_self_intersections(surface, safe);
}

std::size_t make_level(mesh::SurfaceEditor& surface, std::size_t triangles, const TriMesh& fine,
                       const mesh::ClosestPoint& on_fine, const FitPoints& points, const LevelPlan& plan) {
  const LevelMaker maker(fine, on_fine, points, triangles, plan);
  maker.begin(surface);
  maker.finish(surface);
  return surface.triangles();
}

}  // namespace dynasurf::cloud
