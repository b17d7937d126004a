#pragma once
#include <cstdint>
#include <vector>

#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/core/point_cloud.hpp"

namespace dynasurf::cloud {

/// Points with the direction outwards and the area that each one stands for.
struct OrientedPoints {
  std::vector<Vec3> points, normals;
  std::vector<double> areas;
  std::vector<std::uint32_t> sheet;  // points of one sheet have directions that agree with each other
  std::uint32_t sheets = 0;
  bool is_seen = false;  // most of them, by area, are turned to the places they were scanned from
};

/// Adds points, without their sheets.
void append(OrientedPoints& to, const OrientedPoints& more);

/// The first `count` points, without their sheets.
OrientedPoints first_of(OrientedPoints points, std::size_t count);

/// Merges the points in each cube of side `cell` to their mean, so that many points cost no more than the surface asks
/// for. Normals are merged too; a zero normal means that there is none. Where scanners' places are known, each keeps
/// the scan of one of its points. With `cell` 0 all stay as they are.
PointCloud voxel_downsample(const PointCloud& cloud, double cell);

/// Draws every point onto the plane of the `ring` points of the scan nearest to it, which takes most of the noise off.
void project_to_local_planes(PointCloud& cloud, const std::vector<Vec3>& scan, const KdTree& of_scan, std::size_t ring);

/// Estimates the plane at each point from its `ring` nearest neighbours, and turns neighbours the same way: those that
/// clearly agree first, then sets of them by what all links between them say in sum (after Hoppe et al. 1992, with the
/// rule of König and Gumhold 2009 for the two sides of an edge, and Keuper et al. 2015 for the sums). Each sheet is
/// turned to where it was scanned from, where that is known and its points agree; else so that it encloses a positive
/// volume, an open one by its outermost points. Normals of the cloud that are not zero are taken as they are, or all
/// turned where they point into what they enclose.
OrientedPoints orient(const PointCloud& cloud, bool use_normals, std::size_t ring = 12);

/// Gives each point the mean direction of its `ring` nearest points: single ones that noise has turned go with the
/// rest.
void smooth_normals(OrientedPoints& points, std::size_t ring = 14);

}  // namespace dynasurf::cloud
