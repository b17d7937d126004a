#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "dynasurf/cloud/certificate.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf {

/// One mesh, fitted to the cloud, in the cloud's own frame and unit.
struct CloudLevel {
  int triangles_asked = 0;
  TriMesh mesh;
  Certificate certificate;                           // against the points that were used
  std::vector<float> errors;                         // at the vertices, see Comparison
  std::vector<std::array<std::uint8_t, 3>> colours;  // at the vertices; empty when the cloud has none
};

/// What was found in the cloud; lengths in its unit.
struct CloudFacts {
  std::size_t points = 0;                                    // read
  std::size_t not_finite = 0, duplicates = 0, outliers = 0;  // dropped
  std::size_t points_used = 0;                               // what is left
  double diagonal = 0;                                       // of the bounding box of what is left
  double spacing = 0;                                        // median side of the square that a point stands for
  double noise = 0;                                          // standard deviation off the surface
  int cells = 0;                                             // of the grid along its longest side
  int parts = 0;                                             // separate surfaces
  int genus = 0;                                             // sum over the parts
};

struct CloudResult {
  std::vector<CloudLevel> levels;  // as asked for, finest first
  CloudFacts facts;
  PointCloud used;  // the points that the levels were fitted to, near ones together
  Notes notes;      // "cloud.not_finite", "cloud.duplicates", "cloud.outliers", "cloud.left_out", "cloud.handles", …
};

}  // namespace dynasurf
