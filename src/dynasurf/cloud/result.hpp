#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/cloud/detail/certificate.hpp"
#include "dynasurf/cloud/options.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// One mesh, fitted to the cloud, in the cloud's own frame and unit.
struct Level {
  int triangles_asked = 0;
  TriMesh mesh;
  Certificate certificate;                           // against the points that were used
  std::vector<float> errors;                         // at the vertices, see Comparison
  std::vector<float> confidence;                     // at the vertices, see `confidences`
  std::vector<std::array<std::uint8_t, 3>> colours;  // at the vertices; empty when the cloud has none
};

/// What was found in the cloud; lengths in its unit.
struct Facts {
  std::size_t points = 0;                                    // read
  std::size_t not_finite = 0, duplicates = 0, outliers = 0;  // dropped
  std::size_t points_used = 0;                               // what is left
  double diagonal = 0;                                       // of the bounding box of what is left
  double spacing = 0;                                        // median side of the square that a point stands for
  double noise = 0;                                          // standard deviation off the surface
  int cells = 0;                                             // of the grid along its longest side
  int parts = 0;                                             // separate surfaces
  int genus = 0;                                             // sum over the parts
  BoundaryRule boundary = BoundaryRule::close;               // what was done where the points end; not `automatic`
  int boundary_loops = 0;                                    // of an open surface
};

/// What the points say about the body; shares are from 0 to 1, lengths in the cloud's unit.
struct CloudSupport {
  double within = 0;           // surface nearer than this to a point is supported by it
  double points_off = 0;       // share of the points farther from the finest level than noise and triangles explain
  double points_left_out = 0;  // share of the points farther than 2 % of the diagonal from it, and not alone there
  double points_off_mean = 0;  // mean distance of the points from it over what noise and spacing explain
  double biased = 0;           // share of the points in patches that lie off it to one side
  double made_up = 0;          // share of its area that no point supports
  double made_up_largest = 0;  // the largest distance of the surface from all points over the diagonal
  double unfaced_points = 0;   // of at most 20,000, that its largest part ought to hold that none of them faces
  double turned = 0;           // share of the points whose direction was found against the surface
  double thin = 0;             // share of its area with the other side nearer than the points or the lattice resolve
  double gaps = 0;             // of that, the share whose other side is nearer through the space outside
  // Of the surfaces at levels and lattices around it that the points do not contradict, the share with its parts and
  // handles; 1 for an open one.
  double firm = 1;
  double cell = 0;  // side of the lattice that the body was found on; 0: none
};

/// Whether a result can be trusted: yes; after a look at what the flags say; no.
enum class Verdict { ok, check, fail };
std::span<const std::string_view> names_of(Verdict);

/// What `reconstruct` made of a cloud.
struct Result {
  std::vector<Level> levels;  // as asked for, finest first
  Facts facts;
  CloudSupport support;
  PointCloud used;  // the points that the levels were fitted to, near ones together
  Notes notes;      // "cloud.not_finite", "cloud.duplicates", "cloud.outliers", "cloud.left_out", "cloud.handles", …
};

/// Whether every level may be published as watertight. False without a level.
bool is_watertight(const Result& result);

/// Whether a level is what it should be: watertight, or sound and open where the surface was left open.
bool is_sound(const Result& result, const Level& level);

/// `fail` where a level is not sound or a note tells of a failure, else `check` where one warns, else `ok`.
Verdict verdict_of(const Result& result);

}  // namespace dynasurf::cloud
