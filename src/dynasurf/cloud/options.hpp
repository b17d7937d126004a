#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/options.hpp"

namespace dynasurf::cloud {

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

/// What becomes of the places where the points end. `close`: a watertight body, closed over every opening. `keep`: an
/// open surface that ends with the points on its outside, with its inner holes closed: of every piece the loops at
/// least half as long as its longest stay open. `trim`: an open surface without any place that no point supports.
/// `automatic`: `keep` where the points all face one way more or less, as those of a terrain, a cap or a front do, else
/// `close`.
enum class BoundaryRule { automatic, close, keep, trim };
std::span<const std::string_view> names_of(BoundaryRule);

/// What closes the holes of a body. `smooth`: the surface around goes on, as evenly bent as can be. `flat`: the surface
/// of least area, with an edge at the rim: flat where the rim lies in a plane.
enum class LidRule { smooth, flat };
std::span<const std::string_view> names_of(LidRule);

/// From a cloud to light meshes, closed or open.
struct Options {
  CloudMethod method = CloudMethod::shaped;
  std::vector<int> triangles{5120, 1280, 320};
  std::optional<double> max_error_percent;
  GenusRule genus = GenusRule::automatic;
  CloudStart start = CloudStart::automatic;
  BoundaryRule boundary = BoundaryRule::automatic;
  LidRule lid = LidRule::smooth;
  bool keep_sharp = false;
  std::optional<int> cells;
  std::optional<double> noise_percent;
  double outliers = 6;
  bool use_normals = true;
  double smallest_part_percent = 2;
};
void describe(auto& visit, Options& o) {
  visit(
      "method", o.method,
      OptionInfo{"shaped: well-shaped triangles; faithful: the smallest distance, slender triangles where the surface "
                 "asks for them; thesis: the voxels, icosphere and free model of thesis 6.2"});
  visit("triangles", o.triangles,
        OptionInfo{"triangles of each level, even and falling; thesis: 20 times a power of 4", "", 20, 2e6});
  visit(
      "max_error_percent", o.max_error_percent,
      OptionInfo{"one level with the fewest triangles, in steps of a tenth, whose mean distance to the points is below "
                 "this; instead of `triangles`",
                 "% of the bounding box's diagonal", 1e-4, 10});
  visit("genus", o.genus,
        OptionInfo{"auto: the handles that the data show clearly; 0: none; keep: all that appear at the finest grid"});
  visit("start", o.start,
        OptionInfo{
            "the mesh that is deformed: field: the field's own surface; sphere, ellipsoid, hull: around every part, "
            "without handles; auto: field, for thesis ellipsoid"});
  visit(
      "boundary", o.boundary,
      OptionInfo{"where the points end: close: a watertight body; keep: an open surface, inner holes closed; trim: an "
                 "open surface without any place that no point supports; auto: keep for points that face one way, "
                 "such as a terrain's, else close"});
  visit("lid", o.lid,
        OptionInfo{"what closes a hole: smooth: the surface around it goes on; flat: the least area, as of a base to "
                   "stand on"});
  visit("keep_sharp", o.keep_sharp, OptionInfo{"no smoothing across edges that the points show to be sharp"});
  visit("cells", o.cells,
        OptionInfo{"grid cells along the longest side; absent: from the spacing and noise", "", 16, 512});
  visit("noise_percent", o.noise_percent,
        OptionInfo{"standard deviation of the points off the surface; absent: estimated",
                   "% of the bounding box's diagonal", 0, 10});
  visit("outliers", o.outliers,
        OptionInfo{
            "points are dropped when they lie this many times farther from their neighbours than is usual; 0: none", "",
            0, 1e6});
  visit("use_normals", o.use_normals, OptionInfo{"trust the directions of the cloud's normals where it has them"});
  visit("smallest_part_percent", o.smallest_part_percent,
        OptionInfo{"separate parts with a smaller share of the points are dropped", "%", 0, 50});
}

/// "shaped", "faithful", "thesis".
std::span<const std::string_view> preset_names();
/// Throws OptionError with the choices for an unknown name.
Options preset(std::string_view name);

/// Throws OptionError for any option out of its range, for method thesis with a surface that is to be open, for flat
/// lids with either, and unless `triangles` holds even numbers that fall.
void check(const Options& options);

}  // namespace dynasurf::cloud
