#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/cloud/certificate.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf {

/// How the surface is made. `shaped`: well-shaped triangles. `faithful`: triangles that follow the curvature, for the
/// smallest distance. `thesis`: 62^3 voxels, an icosphere, gradient vector flow and the free model (thesis 6.2).
enum class CloudMethod { shaped, faithful, thesis };
std::span<const std::string_view> names_of(CloudMethod);

/// Which handles the surface has. `automatic`: those the data show clearly. `zero`: none, every part is a sphere.
/// `keep`: all that the inside has at the finest level.
enum class GenusRule { automatic, zero, keep };
std::span<const std::string_view> names_of(GenusRule);

/// What is deformed into the surface. `field`: the level surface of the field between inside and outside, with its
/// handles. `sphere`, `ellipsoid`, `hull`: around every part, without handles. `automatic`: the field's surface, for
/// method thesis the ellipsoid.
enum class CloudStart { automatic, field, sphere, ellipsoid, hull };
std::span<const std::string_view> names_of(CloudStart);

/// From a cloud to light closed meshes.
struct CloudOptions {
  CloudMethod method = CloudMethod::shaped;
  std::string triangles = "5120,1280,320";
  std::optional<double> max_error_percent;
  GenusRule genus = GenusRule::automatic;
  CloudStart start = CloudStart::automatic;
  bool keep_sharp = false;
  std::optional<int> cells;
  std::optional<double> noise_percent;
  double outliers = 6;
  bool use_normals = true;
  double smallest_part_percent = 2;
};
void describe(auto& visit, CloudOptions& o) {
  visit("method", o.method,
        Field{"shaped: well-shaped triangles; faithful: the smallest distance, slender triangles where the surface "
              "asks for them; thesis: the voxels, icosphere and free model of thesis 6.2"});
  visit("triangles", o.triangles,
        Field{"triangles of each level, falling, with commas between them; thesis: 20 times a power of 4"});
  visit("max_error_percent", o.max_error_percent,
        Field{"one level with the fewest triangles, in steps of a tenth, whose mean distance to the points is below "
              "this; instead of `triangles`",
              "% of the bounding box's diagonal", 1e-4, 10});
  visit("genus", o.genus,
        Field{"auto: the handles that the data show clearly; 0: none; keep: all that appear at the finest grid"});
  visit("start", o.start,
        Field{"the mesh that is deformed: field: the field's own surface; sphere, ellipsoid, hull: around every part, "
              "without handles; auto: field, for thesis ellipsoid"});
  visit("keep_sharp", o.keep_sharp, Field{"no smoothing across edges that the points show to be sharp"});
  visit("cells", o.cells, Field{"grid cells along the longest side; absent: from the spacing and noise", "", 16, 512});
  visit("noise_percent", o.noise_percent,
        Field{"standard deviation of the points off the surface; absent: estimated", "% of the bounding box's diagonal",
              0, 10});
  visit("outliers", o.outliers,
        Field{"points are dropped when they lie this many times farther from their neighbours than is usual; 0: none",
              "", 0, 1e6});
  visit("use_normals", o.use_normals, Field{"trust the directions of the cloud's normals where it has them"});
  visit("smallest_part_percent", o.smallest_part_percent,
        Field{"separate parts with a smaller share of the points are dropped", "%", 0, 50});
}

/// "shaped", "faithful", "thesis".
std::span<const std::string_view> cloud_preset_names();
/// Throws OptionError with the choices for an unknown name.
CloudOptions cloud_preset(std::string_view name);

/// The numbers in `triangles`, in their order. Throws OptionError unless they are even, from 20 to 2,000,000, and fall.
std::vector<int> parse_triangles(const std::string& triangles);

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

/// Closed surfaces from points (thesis 6.2; GEN-*). Every level is fitted to the points themselves. A level that is not
/// watertight says so in its certificate, and a note of severity failure stands in the result, as it does
/// ("cloud.no_surface") where the points fill space instead of lying on a surface. The same bytes for any
/// number of threads. Progress stages: "points", "inside", "surface", "levels". Throws OptionError for an option out
/// of range, InputError for fewer than 10 usable points, or points that all lie in one plane.
CloudResult reconstruct_cloud(PointCloud cloud, const CloudOptions& options, const Progress& progress = {});

}  // namespace dynasurf
