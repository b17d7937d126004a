#pragma once
#include <cstddef>
#include <vector>

#include "dynasurf/cloud/detail/fit.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/detail/surface_editor.hpp"

namespace dynasurf::cloud {

/// How a level of detail is made from a finer surface. Lengths are in units of the cloud's diagonal.
struct LevelPlan {
  double evenness = 1e-4;            // of the triangles, see Simplify
  double collapse_angle_deg = 20;    // see Simplify
  double largest_bend_deg = 30;      // of flips
  int rounds = 2;                    // of flips, moves within the surface, and fits
  int sweeps = 2;                    // of moves within the surface in a round
  double raise_deg = 30;             // the smallest angle asked for before the last fit
  double hold_angle_deg = 28.5;      // the fit makes no angle smaller than this
  double smallest_angle_deg = 20.5;  // asked for in the end
  int fits = 2;                      // of a round
  int last_fits = 4;                 // of the last one
  double sharp_deg = 180;            // edges this sharp keep their vertices
  double hold = 0.005;
  double smoothness = 1e-4;
  double noise = 0;                 // of the points, where it is larger than their spacing
  double points_per_triangle = 10;  // that the fit uses, at most
  double fewest_points = 25600;     // but this many where there are; a few triangles cost little each
};

LevelPlan shaped_plan();
LevelPlan faithful_plan();

/// Every so many of the points serve the fit of a level.
std::size_t step_of_fit(const LevelPlan& plan, std::size_t points, std::size_t triangles);

/// Collapses edges to `triangles` with well-shaped ones, never letting the surface meet itself.
void make_lighter(mesh::SurfaceEditor& surface, std::size_t triangles);

/// What `make_level` does first where it makes many triangles, and needs no points for: collapses. Done before, they
/// are not done again.
void lighten_for_level(mesh::SurfaceEditor& surface, std::size_t triangles, const LevelPlan& plan);

/// Takes surfaces (free of self-intersections) down to `triangles`, with triangles as the plan asks for, fitted to the
/// points. `fine` is the surface that vertices slide on. Closed or open as before, manifold, of the same genus, and
/// free of self-intersections after each half; with more triangles than asked for where no edge may go.
class LevelMaker {
 public:
  LevelMaker(const TriMesh& fine, const mesh::ClosestPoint& on_fine, const FitPoints& points, std::size_t triangles,
             const LevelPlan& plan);

  /// All rounds but the last: good enough to make the next level from.
  void begin(mesh::SurfaceEditor& surface) const;
  /// The last round.
  void finish(mesh::SurfaceEditor& surface) const;

 private:
  FitOptions fitting(int rounds) const;
  void shape(mesh::SurfaceEditor& surface) const;

  const TriMesh& fine_;
  const mesh::ClosestPoint& on_fine_;
  FitPoints points_;
  std::size_t triangles_;
  LevelPlan plan_;
  std::vector<Vec3> some_, normals_;
};

/// Both halves; returns the number of triangles.
std::size_t make_level(mesh::SurfaceEditor& surface, std::size_t triangles, const TriMesh& fine,
                       const mesh::ClosestPoint& on_fine, const FitPoints& points, const LevelPlan& plan);

}  // namespace dynasurf::cloud
