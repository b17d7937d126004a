#include "dynasurf/core/parallel.hpp"
#include "dynasurf/ventricle/detail/gate_run.hpp"

namespace dynasurf::ventricle {
namespace {

/// The surface on the steepest slope of the image; the border lies on a grid with room around it.
TriMesh settled(TriMesh mesh, const Grid& border, const Image& image, const Options& options) {
  const Vec3 shift = to_grid(border, image.grid.origin);
  for (Vec3& p : mesh.vertices) p -= shift;
  const Vec3 base{0, 0, options.closure.cover ? 1.0 : 0.0};
  mesh = settle_on_slope(std::move(mesh), image, base, options.settle);
  for (Vec3& p : mesh.vertices) p += shift;
  return mesh;
}

void find_surface(WallRun& run, const TriMesh& start, const Options& options, const Progress& quiet,
                  StageClock& clock) {
  const Image& map = options.pipeline == Pipeline::direct ? run.edge_map : run.border;
  run.start = start;
  run.flow = clock("field", [&] { return field::flow_field(map, options.field, quiet); });
  run.evolved = clock("surfaces", [&] {
    return dynamics::evolve(start, run.flow.field, run.border, options.evolution, quiet, &run.planes);
  });
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

/// The former surface, a little enlarged about its centre, so that the next one is reached from outside
/// (FUT-WARMSTART); or shrunk, for surfaces that grow.
TriMesh resized(TriMesh mesh, mesh::Direction direction) {
  const double growth = direction == mesh::Direction::out_to_in ? 1.15 : 1 / 1.15;
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : mesh.vertices) centre += p / static_cast<double>(mesh.vertices.size());
  for (Vec3& p : mesh.vertices) p = centre + growth * (p - centre);
  return mesh;
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
        found_(progress, "surfaces", 2 * static_cast<int>(gates)),
        clock_(clock) {}

  void from_start(WallRun& run) {
    progress_.check();
    if (run.exists())
      find_surface(run, mesh::start_mesh(run.border, options_.mesh_level, run.placement, start_), options_, quiet_,
                   clock_);
    found_.advance();
  }
  void from_former(WallRun& run, const TriMesh& former) {
    progress_.check();
    find_surface(run, resized(former, run.placement.direction), options_, quiet_, clock_);
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

/// Each gate's surface starts from that of the gate before (FUT-WARMSTART).
void follow_beat(std::vector<GateRun>& runs, Border wall, SurfaceSearch& search) {
  const WallRun* former = nullptr;
  for (GateRun& gate : runs) {
    WallRun& run = gate.wall(wall);
    if (former == nullptr || !run.exists())
      search.from_start(run);
    else
      search.from_former(run, former->evolved.mesh);
    if (run.exists()) former = &run;
  }
}

}  // namespace

void find_surfaces(std::vector<GateRun>& runs, const Study& study, const Options& options, const TriMesh* start,
                   const Progress& progress, StageClock& clock) {
  SurfaceSearch search(options, start, progress, runs.size(), clock);
  if (options.pipeline == Pipeline::contour)
    parallel_for(runs.size(), 1, [&](std::size_t g, std::size_t) { search.from_contours(runs[g], study.gates[g]); });
  else if (options.warm_start)
    parallel_for(walls.size(), 1, [&](std::size_t w, std::size_t) { follow_beat(runs, walls[w], search); });
  else
    parallel_for(2 * runs.size(), 1,
                 [&](std::size_t task, std::size_t) { search.from_start(runs[task / 2].wall(walls[task % 2])); });
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
  });
}

}  // namespace dynasurf::ventricle
