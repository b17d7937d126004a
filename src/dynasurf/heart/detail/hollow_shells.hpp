#pragma once
#include <array>
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::heart {

/// Radii of the shells that are tried.
inline constexpr std::array<double, 5> shell_radii_mm{17, 22, 28, 36, 46};
/// Two places nearer than this are one.
inline constexpr double places_apart_mm = 22;

/// The 26 directions of a cube's corners, edges and faces.
std::vector<Vec3> cube_directions();

/// A place that looks like the middle of a hollow shell. Grid frame, mm.
struct Place {
  Vec3 centre{0, 0, 0};
  double radius_mm = 0, worth = 0;
};

/// The ten best places of an image with cubic voxels, the best first: every voxel is the middle of shells of all radii,
/// and each shell is worth its contrast in its middling directions.
std::vector<Place> find_places(const Image& coarse);

}  // namespace dynasurf::heart
