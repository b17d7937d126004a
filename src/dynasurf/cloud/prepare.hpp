#pragma once
#include "dynasurf/cloud/neighbours.hpp"
#include "dynasurf/cloud/reconstruct_cloud.hpp"

namespace dynasurf {

/// What is left of a cloud to work on. Points stand in the order of the tree, near ones together, and the other arrays
/// with them.
struct PreparedCloud {
  PointCloud cloud;
  Neighbours neighbours;  // of the cloud's points
  CloudFacts facts;       // up to `noise`
  Notes notes;
};

/// Drops points that are not finite, repeated, or outliers, and measures spacing and noise. Throws InputError for fewer
/// than 10 points left, points in one plane, and arrays of the wrong length.
PreparedCloud prepare(PointCloud cloud, const CloudOptions& options, const Progress& progress = {});

}  // namespace dynasurf
