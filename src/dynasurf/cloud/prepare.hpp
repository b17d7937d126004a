#pragma once
#include "dynasurf/cloud/reconstruct_cloud.hpp"

namespace dynasurf {

/// What is left of a cloud to work on. Points keep their order, and the other arrays stay with them.
struct PreparedCloud {
  PointCloud cloud;
  CloudFacts facts;  // up to `noise`
  Notes notes;
};

/// Drops points that are not finite, repeated, or outliers, and measures spacing and noise. Throws InputError for fewer
/// than 10 points left, points in one plane, and arrays of the wrong length.
PreparedCloud prepare(const PointCloud& cloud, const CloudOptions& options, const Progress& progress = {});

}  // namespace dynasurf
