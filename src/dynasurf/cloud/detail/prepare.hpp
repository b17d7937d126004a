#pragma once
#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/cloud/options.hpp"
#include "dynasurf/cloud/result.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/progress.hpp"

namespace dynasurf::cloud {

/// What is left of a cloud to work on. Points stand in the order of the tree, near ones together, and the other arrays
/// with them.
struct PreparedCloud {
  PointCloud cloud;
  KdTree neighbours;  // looks at the cloud's points
  Facts facts;        // up to `noise`
  Notes notes;
};

/// Tells of points that belong to no surface, where there are any.
void note_outliers(std::size_t count, Notes& notes);

/// Noise that neighbours differ by.
bool is_noisy(const Facts& facts);

/// Drops points that are not finite, repeated, or outliers, and measures spacing and noise. Throws InputError for fewer
/// than 10 points left, points in one plane, and arrays of the wrong length.
PreparedCloud prepare(PointCloud cloud, const Options& options, const Progress& progress = {});

}  // namespace dynasurf::cloud
