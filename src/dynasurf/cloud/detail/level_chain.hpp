#pragma once
#include <functional>
#include <span>
#include <vector>

#include "dynasurf/cloud/detail/levels.hpp"
#include "dynasurf/cloud/detail/prepare.hpp"
#include "dynasurf/cloud/options.hpp"
#include "dynasurf/cloud/result.hpp"
#include "dynasurf/core/progress.hpp"

namespace dynasurf::cloud {

/// Whether the surface ends where the points do.
bool is_open(const Facts& facts);

/// The plan that the options and the noise of the points ask for.
LevelPlan plan_of(const Options& options, const Facts& facts, std::size_t triangles);

/// What every level is made from. Lengths are in units of the cloud's diagonal.
struct Fitting {
  const TriMesh& fine;
  const mesh::ClosestPoint& on_fine;
  FitPoints points;               // of the scan and in its holes
  std::span<const Vec3> scanned;  // of the scan alone
  const Options& options;
  const Facts& facts;
};

/// A level and what is to be told of it.
struct MeasuredLevel {
  Level level;
  Notes notes;
};

/// Holds a mesh in the cloud's frame against the points that were used.
MeasuredLevel measure_level(const PreparedCloud& p, const Facts& facts, int asked, TriMesh mesh);

/// Gives a mesh in units of the diagonal, of so many triangles as asked for, to `measure_level`.
using Measure = std::function<MeasuredLevel(TriMesh mesh, int asked)>;

/// Makes levels, each from the one before it while that is finished and measured: each leaves the other's processor
/// idle at times. The same for any number of threads.
std::vector<MeasuredLevel> make_levels(mesh::SurfaceEditor surface, const Fitting& fitting,
                                       const std::vector<int>& triangles, const Measure& measure,
                                       const Progress& progress);

/// The most triangles that a level within an error has.
constexpr int most_triangles_within_error = 40960;

/// Leaves in `surface` the level with the fewest triangles whose points are within `error` of it on the mean, and
/// returns their number. "cloud.max_error" tells where none is.
int fewest_within(mesh::SurfaceEditor& surface, const Fitting& fitting, double error, Notes& notes,
                  const Progress& progress);

}  // namespace dynasurf::cloud
