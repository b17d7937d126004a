#pragma once
#include <span>
#include <vector>

#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/cloud/result.hpp"
#include "dynasurf/mesh/closest_point.hpp"

namespace dynasurf::cloud {

/// The points that were used, their tree, and what is known of them.
struct SupportingPoints {
  std::span<const Vec3> points;
  const KdTree& tree;  // of these points, which bear their numbers in it
  const Facts& facts;
};

/// Surface nearer than this to a point is supported by it: three times the spacing, wider by three times the noise.
double supported_within(const Facts& facts);

/// How well the points support the surface at each vertex: 1 within the supported distance of one, else that distance
/// over the distance to the nearest point, which falls to 0. Where the points themselves lie farther apart than usual,
/// up to four times, the surface may lie farther from them by as much.
std::vector<float> confidences(const TriMesh& mesh, const SupportingPoints& cloud);

/// Of `asked` points those with the numbers `far` lie farther than `limit` from a mesh: how many of them it left out.
/// At least three of the six points nearest to such a one lie as far from the mesh, within five spacings; or farther
/// apart, where one in 200 of the points is left out, as of a floor. The others are stray points. The same for any
/// number of threads.
std::size_t left_out_of(std::span<const std::size_t> far, std::size_t asked, const SupportingPoints& cloud,
                        const mesh::ClosestPoint& closest, double limit);

/// Measures what the points say about the finest level, the first one: all of `support` but `cell`, `turned` and
/// `firm`, which are known from the search for the body. The confidence of all levels falls where no point faces the
/// surface. The same for any number of threads.
void measure_support(std::span<Level> levels, const SupportingPoints& cloud, CloudSupport& support);

/// The notes that the measures give reason for, warnings but for thin walls of a closed surface.
Notes doubts_of(const CloudSupport& support, bool is_open);

}  // namespace dynasurf::cloud
