#include <algorithm>

#include "dynasurf/core/detail/mean_point.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/detail/damping.hpp"
#include "dynasurf/mesh/detail/ray_bvh.hpp"
#include "dynasurf/ventricle/detail/closure.hpp"
#include "dynasurf/ventricle/detail/gate_run.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double least_growth = 1.05;  // of a surface before it becomes the start of a neighbour's

/// The surface on the steepest slope of the image; the border lies on a grid with room around it.
TriMesh settled(TriMesh mesh, const Grid& border, const Image& image, const Options& options) {
  const Vec3 shift = to_grid(border, image.grid.origin);
  for (Vec3& p : mesh.vertices) p -= shift;
  const Vec3 base{0, 0, options.closure.cover ? 1.0 : 0.0};
  mesh = settle_on_slope(std::move(mesh), image, base, options.settle);
  for (Vec3& p : mesh.vertices) p += shift;
  return mesh;
}

/// What the image adds to the options: the drag by intensity (VOL-DAMP (a)).
dynamics::Additions additions_of(const WallRun& run, const Image& image, const dynamics::Evolution& evolution) {
  dynamics::Additions own;
  if (std::holds_alternative<dynamics::IntensityDrag>(evolution.damping)) own.drag = drag_of(run, image, evolution);
  return own;
}

void find_surface(WallRun& run, const Image& image, const TriMesh& start, const Options& options, const Progress& quiet,
                  StageClock& clock) {
  run.start = start;
  make_field(run, options, quiet, clock);
  run.evolved = clock("surfaces", [&] {
    dynamics::Additions own = additions_of(run, image, options.evolution);
    own.planes = &run.planes;
    return dynamics::evolve(start, run.flow.field, run.border, options.evolution, quiet, own);
  });
  run.planes = {};
  // Fields of all gates are much of the memory of a study; only those who look at the motion afterwards want them.
  if (!options.evolution.histories && options.evolution.trajectory_every == 0) run.flow.field = {};
}

/// The outer wall first: it bounds the search for the inner one. A wall without contours keeps no border and no mesh.
void find_contours(GateRun& run, const Image& image, const Options& options, StageClock& clock) {
  WallContours outer;
  for (const Border wall : {Border::epi, Border::endo}) {
    if (!run.wall(wall).exists()) continue;
    WallContours contours = clock("contours", [&] {
      return propagate_contours(image, run.labels, wall, run.base_slice, options.contour,
                                outer.found > 0 ? &outer : nullptr);
    });
    auto surface = contour_surface(contours, image.grid, options.contour);
    if (surface) {
      // The border lies on a grid with room around it.
      const Vec3 shift = to_grid(run.wall(wall).border.grid, image.grid.origin);
      for (Vec3& p : surface->evolved.mesh.vertices) p += shift;
      run.wall(wall).evolved = std::move(surface->evolved);
      run.wall(wall).stack = surface->volumes;
      run.wall(wall).contours = contours;
    } else {
      run.wall(wall) = {};
      run.notes.insert(run.notes.end(), contours.notes.begin(), contours.notes.end());
    }
    if (wall == Border::epi) outer = std::move(contours);
  }
}

/// A surface in the frame of another grid: borders have as much room around them as they need.
TriMesh on_grid(TriMesh mesh, const Grid& from, const Grid& to) {
  return from.origin == to.origin ? mesh : to_grid(to, to_world(from, std::move(mesh)));
}

/// An ordinary start drawn onto a neighbour's surface: each vertex stays on its ray from the middle of that surface, so
/// that vertices do not crowd from gate to gate, and lies as much farther out that the whole border is inside and is
/// reached from outside, also where the heart has grown (FUT-WARMSTART); or as much farther in that all of it is
/// outside, for surfaces that grow. Absent where the surface cannot be seen whole from its middle, or would have to
/// change as far as an ordinary start.
std::optional<TriMesh> drawn_onto(TriMesh start, const TriMesh& former, const Image& border,
                                  const mesh::Placement& placement) {
  const bool grows = placement.direction == mesh::Direction::in_to_out;
  const mesh::RayBvh surface(former);
  const Vec3 centre = mean_point(former.vertices);
  const auto radius_along = [&](const Vec3& way) -> double {
    const auto hit = surface.first_hit(centre, way.normalized());
    return hit && hit->from_behind ? hit->distance : 0;
  };
  const Grid& grid = border.grid;
  const double half_voxel = grid.spacing.norm() / 2;
  double factor = grows ? 1 / least_growth : least_growth;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        if (border(i, j, k) == 0) continue;
        const Vec3 way = centre_of(grid, {i, j, k}) - centre;
        const double distance = way.norm(), radius = distance > half_voxel ? radius_along(way) : 0;
        if (!(radius > 0)) return std::nullopt;
        factor = grows ? std::min(factor, (distance - half_voxel) / radius)
                       : std::max(factor, (distance + half_voxel) / radius);
      }
  if (factor > placement.scale || factor < placement.inside_scale) return std::nullopt;
  for (Vec3& p : start.vertices) {
    const Vec3 way = p - centre;
    const double radius = way.norm() > 0 ? radius_along(way) : 0;
    if (!(radius > 0)) return std::nullopt;
    p = centre + factor * radius * way.normalized();
  }
  return start;
}

/// The surface of one wall from a start of its own, and from the surface of the gate before.
class SurfaceSearch {
 public:
  SurfaceSearch(const Options& options, const TriMesh* start, const Progress& progress, std::size_t gates,
                StageClock& clock)
      : options_(options),
        start_(start),
        progress_(progress),
        quiet_{{}, progress.stop},
        found_(progress, "surfaces", 2 * gates),
        clock_(clock) {}

  void from_start(WallRun& run, const Image& image) {
    progress_.check();
    if (run.exists())
      find_surface(run, image, mesh::start_mesh(run.border, options_.mesh_level, run.placement, start_), options_,
                   quiet_, clock_);
    found_.advance();
  }
  /// From the surface of a neighbouring gate, where there is one that can be put around the border.
  void from_former(WallRun& run, const Image& image, const WallRun* former) {
    using enum mesh::StartShape;
    const mesh::StartShape shape = run.placement.shape;
    std::optional<TriMesh> start;
    if (run.exists() && former != nullptr && former->evolved.reason != dynamics::StopReason::diverged &&
        shape != marching_cubes && shape != discretised_cubes)
      start =
          drawn_onto(mesh::start_mesh(run.border, options_.mesh_level, run.placement, start_),
                     on_grid(former->evolved.mesh, former->border.grid, run.border.grid), run.border, run.placement);
    if (!start) return from_start(run, image);
    progress_.check();
    find_surface(run, image, *start, options_, quiet_, clock_);
    found_.advance();
  }
  void from_contours(GateRun& run, const Image& image) {
    progress_.check();
    find_contours(run, image, options_, clock_);
    for ([[maybe_unused]] const Border wall : walls) found_.advance();
  }

 private:
  const Options& options_;
  const TriMesh* start_;
  const Progress& progress_;
  Progress quiet_;
  StageCounter found_;
  StageClock& clock_;
};

/// Each gate's surface starts from that of the gate before, or with `backward` from that of the gate after it
/// (FUT-WARMSTART).
void follow_beat(std::vector<GateRun>& runs, const Study& study, Border wall, bool backward, SurfaceSearch& search) {
  const WallRun* former = nullptr;
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const std::size_t g = backward ? runs.size() - 1 - n : n;
    WallRun& run = runs[g].wall(wall);
    search.from_former(run, study.gates[g], former);
    if (run.exists()) former = &run;
  }
}

}  // namespace

void make_field(WallRun& run, const Options& options, const Progress& progress, StageClock& clock) {
  if (!run.exists() || options.pipeline == Pipeline::contour) return;
  const Image& map = options.pipeline == Pipeline::direct ? run.edge_map : run.border;
  run.flow = clock("field", [&] { return field::flow_field(map, options.field, {{}, progress.stop}); });
}

std::optional<Image> drag_of(const WallRun& run, const Image& image, const dynamics::Evolution& evolution) {
  return dynamics::drag_map(evolution.damping, run.flow.field, run.border, evolution.force.drag,
                            [&] { return spread_to(image, run.border.grid); });
}

void find_surfaces(std::vector<GateRun>& runs, const Study& study, const Options& options, const TriMesh* start,
                   const Progress& progress, StageClock& clock) {
  SurfaceSearch search(options, start, progress, runs.size(), clock);
  if (options.pipeline == Pipeline::contour)
    parallel_for(runs.size(), 1, [&](std::size_t g, std::size_t) { search.from_contours(runs[g], study.gates[g]); });
  else if (options.warm_start)
    parallel_for(walls.size(), 1, [&](std::size_t w, std::size_t) {
      follow_beat(runs, study, walls[w], options.warm_backward, search);
    });
  else
    parallel_for(2 * runs.size(), 1, [&](std::size_t task, std::size_t) {
      search.from_start(runs[task / 2].wall(walls[task % 2]), study.gates[task / 2]);
    });
}

void measure_surfaces(std::vector<GateRun>& runs, const Study& study, const Options& options, StageClock& clock) {
  parallel_for(2 * runs.size(), 1, [&](std::size_t task, std::size_t) {
    WallRun& run = runs[task / 2].wall(walls[task % 2]);
    if (!run.exists()) return;
    const bool settles = options.pipeline != Pipeline::contour && run.evolved.reason != dynamics::StopReason::diverged;
    if (settles && options.settle.rounds > 0)
      run.settled =
          clock("settling", [&] { return settled(run.evolved.mesh, run.border.grid, study.gates[task / 2], options); });
    run.surface = clock("measures", [&] {
      return measure_surface(run.evolved, run.border, runs[task / 2].base_plane, options.tidy,
                             run.settled ? &*run.settled : nullptr);
    });
    run.surface->contours = run.contours;
    if (auto& motion = run.surface->motion) {
      motion->field = run.flow.field;
      motion->drag = drag_of(run, study.gates[task / 2], options.evolution);
    }
  });
}

}  // namespace dynasurf::ventricle
