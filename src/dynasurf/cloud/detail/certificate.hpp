#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// What a mesh is, computed from its triangles alone and without tolerances, and how far it lies from a cloud. Lengths
/// are in the cloud's unit.
struct Certificate {
  std::size_t vertices = 0, triangles = 0;
  bool closed = false;                 // every edge has two triangles or more
  bool manifold = false;               // no edge has more than two, and the triangles of every vertex form one fan
  bool oriented = false;               // neighbours run through their edge in opposite directions
  bool outward = false;                // the signed volume is positive
  std::size_t self_intersections = 0;  // pairs of triangles that meet, by exact predicates
  std::size_t flat_triangles = 0;
  int components = 0;
  int boundary_loops = 0;    // of a manifold, oriented mesh
  std::optional<int> genus;  // sum over the components, each loop closed by a disc; absent unless manifold and oriented

  // Of the smallest angle of each triangle, degrees.
  double smallest_angle_deg = 0, angle_percentile_1_deg = 0, angle_percentile_5_deg = 0, angle_mean_deg = 0;

  double cloud_diagonal = 0;                                 // of the cloud's bounding box
  double cloud_to_mesh_mean = 0, cloud_to_mesh_largest = 0;  // every point to the nearest point of the mesh
  // Points spread evenly over the mesh, and its vertices, to the nearest point of the cloud. Half the spacing of the
  // cloud is the least it can be; over a hole of the cloud it is large for the best of meshes.
  double mesh_to_cloud_mean = 0, mesh_to_cloud_largest = 0;
  double volume = 0, area = 0;  // a volume says nothing for an open mesh

  /// May the mesh be published as watertight?
  bool watertight() const {
    return closed && manifold && oriented && outward && self_intersections == 0 && flat_triangles == 0;
  }
  /// May it be published as an open surface: manifold, oriented, free of crossings, with boundary loops?
  bool sound_open() const {
    return boundary_loops > 0 && manifold && oriented && self_intersections == 0 && flat_triangles == 0;
  }
};

/// Distances are 0 for an empty cloud or mesh. The same for any number of threads. Throws InputError for a vertex or
/// point that is not finite, or a triangle's corner out of range.
Certificate certify(const TriMesh& mesh, const PointCloud& cloud);

/// What a mesh is as a surface, how far it is from a cloud, and where.
struct Comparison {
  Certificate certificate;
  /// Distance of every point to the mesh, gathered at the corners of the nearest triangle: per vertex the mean over the
  /// points that are nearest to its triangles, weighted by closeness to the corner. Vertices that no point is near have
  /// -1: what a level misses of the cloud, and where nothing can be said.
  std::vector<float> errors;
};

/// The certificate against points whose tree is at hand, and what their distances say at each vertex.
Comparison compare(const TriMesh& mesh, const KdTree& cloud);

}  // namespace dynasurf::cloud
