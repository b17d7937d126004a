#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dynasurf/cloud/detail/kd_tree.hpp"

namespace dynasurf::cloud {

/// Neighbours that tell whether a point stands alone.
inline constexpr std::size_t stray_ring = 8;

/// 0 for the points that are no part of a surface: those `factor` times farther from their neighbours than those are
/// from theirs, and those half as far, measured in the usual spacing of the largest sheet, that hang together with too
/// few others or with others that fill space instead of lying on a surface. Two points hang together when each is among
/// the nearest of the other, which scattered points near a surface never are with it. `neighbours` are those of the
/// points. The same for any number of threads.
std::vector<std::uint8_t> parts_of_surfaces(const std::vector<Vec3>& points, const KdTree& neighbours, double factor);

}  // namespace dynasurf::cloud
