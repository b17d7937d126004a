#include "dynasurf/show/detail/motion.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/error.hpp"

namespace dynasurf::show {

Motion move_again(const ShownWall& wall, const field::VectorField& field, const dynamics::Evolution& evolution,
                  std::span<const int> steps, const Progress& progress) {
  Motion motion;
  dynamics::Additions own;
  own.drag = wall.drag;
  own.watch = [&](int step, const TriMesh& mesh) {
    if (std::find(steps.begin(), steps.end(), step) != steps.end())
      motion.frames.push_back({step, mesh, std::vector<bool>(mesh.vertices.size())});
  };
  own.watch(0, wall.start);  // a run calls it after steps only
  motion.result = dynamics::evolve(wall.start, field, wall.border, evolution, progress, own);
  return motion;
}

Motion move_in_frames(const ShownWall& wall, const field::VectorField& field, dynamics::Evolution evolution,
                      std::vector<int> steps, int count, const Progress& progress) {
  evolution.smooth_after.sweeps = 0;  // it would move particles that have stopped
  // Which steps to show is known only when the number of all is: the motion runs twice, and no mesh is kept in vain.
  Motion motion = move_again(wall, field, evolution, {}, progress);
  const int last = motion.result.steps;
  if (steps.empty())
    for (int n = 0; n < count; ++n) steps.push_back(std::lround(last * n * n / ((count - 1.0) * (count - 1.0))));
  for (const int step : steps)
    if (step < 0 || step > last)
      throw OptionError("--steps " + std::to_string(step) + "; the run has " + std::to_string(last));
  motion.frames = move_again(wall, field, evolution, steps, progress).frames;
  const std::vector<Vec3>& end = motion.result.mesh.vertices;
  for (EvolutionFrame& frame : motion.frames)
    for (std::size_t v = 0; v < frame.stopped.size(); ++v)
      frame.stopped[v] = motion.result.stopped[v] != 0 && (frame.mesh.vertices[v] - end[v]).norm() < 1e-9;
  return motion;
}

std::vector<std::vector<Vec2>> paths_in(const ShownWall& wall, const field::VectorField& field,
                                        const dynamics::Evolution& evolution, int k, const Progress& progress) {
  const Vec3& spacing = wall.border.grid.spacing;
  std::vector<std::vector<Vec3>> ways(wall.start.vertices.size());
  dynamics::Additions own;
  own.drag = wall.drag;
  own.watch = [&](int, const TriMesh& mesh) {
    for (std::size_t v = 0; v < ways.size(); ++v) {
      const Vec3 at = mesh.vertices[v].cwiseQuotient(spacing);
      if (ways[v].empty() || (at - ways[v].back()).norm() > 0.25) ways[v].push_back(at);
    }
  };
  own.watch(0, wall.start);
  const TriMesh end = dynamics::evolve(wall.start, field, wall.border, evolution, progress, own).mesh;
  std::vector<std::vector<Vec2>> paths;
  for (std::size_t v = 0; v < ways.size(); ++v) {
    ways[v].push_back(end.vertices[v].cwiseQuotient(spacing));
    if (std::abs(ways[v].back()[2] - k) > 0.5) continue;
    paths.emplace_back();
    for (const Vec3& p : ways[v]) paths.back().emplace_back(p[0], p[1]);
  }
  return paths;
}

}  // namespace dynasurf::show
