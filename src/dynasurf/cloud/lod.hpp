#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/mesh/repair.hpp"

namespace dynasurf::cloud {

// Levels of detail (thesis 6.2.1; GEN-LOD, GEN-MIP, GEN-MIPINTERP, GEN-TESS). A chain of levels runs from the finest
// mesh, level 0, to the coarsest.

/// The picture of a pinhole camera.
struct Camera {
  int width_px = 1920, height_px = 1080;
  double fov_deg = 40;  // vertical field of view
};
void describe(auto& visit, Camera& o) {
  visit("width_px", o.width_px, OptionInfo{"width of the picture", "px", 1, 100000});
  visit("height_px", o.height_px, OptionInfo{"height of the picture", "px", 1, 100000});
  visit("fov_deg", o.fov_deg, OptionInfo{"vertical field of view", "degrees", 0.01, 179});
}

/// Size on the screen, in pixels, of what is 1 long, 1 away and square to the view.
double focal_px(const Camera& camera);

/// Where a camera stands. `forward` and `up` are unit vectors at right angles.
struct CameraPose {
  Vec3 eye{0, 0, 0}, forward{0, 0, -1}, up{0, 1, 0};
};

/// GEN-MIP (b): the longer side, in pixels, of the rectangle around a box projected onto the screen. Infinite when the
/// box reaches the plane of the eye. Independent of whether the box is in view.
double projected_size_px(const Vec3& low, const Vec3& high, const CameraPose& pose, const Camera& camera);

/// When a coarser level is good enough.
struct LodRule {
  double edge_px = 8;
  double hysteresis_percent = 10;
};
void describe(auto& visit, LodRule& o) {
  visit("edge_px", o.edge_px,
        OptionInfo{"a level serves while its mean edge is no longer than this on the screen", "px", 0.01, 10000});
  visit("hysteresis_percent", o.hysteresis_percent,
        OptionInfo{
            "by how much the limit must be passed before the level changes back, and the width of the band in which "
            "one level turns into the next",
            "%", 0, 90});
}

/// What the choice of a level needs to know of a chain.
struct LodChain {
  /// Per level: the largest size on the screen, in pixels, of the box's diagonal at which it serves. Infinite for level
  /// 0, then falling.
  std::vector<double> largest_px;
  double diagonal = 0;  // of the box around level 0
  LodRule rule;
};

/// Levels must be given finest first, each with triangles. A level whose edges are no longer than those of the level
/// before it never serves longer. Throws InputError for an empty chain or level, OptionError.
LodChain lod_chain(std::span<const TriMesh> levels, const LodRule& rule = {});

/// GEN-MIP (b): the coarsest level that serves at this size of the diagonal on the screen. With a current level, the
/// change waits until the limit is passed by the hysteresis, so a size that trembles around it changes nothing.
std::size_t level_for_size(const LodChain& chain, double diagonal_px, std::optional<std::size_t> current = {});

/// GEN-MIP (a): for a fixed camera, from which distance on each level serves: 0 for level 0, then rising.
std::vector<double> switch_distances(const LodChain& chain, const Camera& camera);

/// The level for a distance by intervals that the user has set: level i serves from `from[i]` on; `from[0]` is 0 and
/// they rise. With a current level, the change waits for the hysteresis.
std::size_t level_for_distance(std::span<const double> from, double distance, std::optional<std::size_t> current = {},
                               double hysteresis_percent = 10);

/// GEN-MIPINTERP: a finer level that grows out of a coarser one.
struct LodTransition {
  TriMesh fine;             // at t = 1: the finer level, its triangles cut where `start` needs it; its vertices first
  std::vector<Vec3> start;  // place of each of its vertices at t = 0, on the coarse surface
  /// The two ends of the edge of `fine` that each vertex beyond those of the finer level halves, in their order.
  std::vector<std::array<std::uint32_t, 2>> cuts;
  bool exact = false;  // at t = 0 the shape is the coarse surface itself
};

/// When `fine` is `coarse` with every triangle cut in four and the coarse vertices first (as icospheres are), every new
/// vertex starts in the middle of its two parents. Else every vertex starts at the nearest point of the coarse surface
/// that faces the same way, and triangles of `fine` are cut until all corners of each start within one coarse triangle:
/// the shape at t = 0 is the coarse surface then, too, to rounding. Where the nearest point jumps between sheets of the
/// coarse surface that nearly touch, starts between them are led along its edges. Should triangles be left that cut its
/// corners, `exact` is false and `start_distance` tells by how much. Throws InputError for a mesh without triangles.
LodTransition lod_transition(const TriMesh& coarse, const TriMesh& fine);

/// How far a shape is off another one, in the unit of the meshes.
struct StartDistance {
  double mean = 0, largest = 0;
};

/// Between the shape at t = 0 and the coarse surface, at vertices and middles of edges and triangles, both ways.
StartDistance start_distance(const LodTransition& transition, const TriMesh& coarse);

/// The shape at t in [0, 1]: the vertices move on straight lines, so shape and volume are continuous.
TriMesh at_transition(const LodTransition& transition, double t);

/// A shape between two levels in which no triangles meet.
struct FreeShape {
  TriMesh mesh;
  mesh::SurfaceCheck check;  // nothing meets and nothing is flat where the finer level is sound and t is above 0
  std::size_t met = 0;       // pairs of triangles that meet on the straight lines, and flat triangles
  std::size_t ahead = 0;     // vertices that stand where they end instead, so that none do
};

/// The shape at t, where vertices of triangles that meet, and as many around them as it takes, are already where they
/// end. At t = 0, where many triangles are flat, and for meshes that are no manifold, the shape is left as it is.
FreeShape free_at_transition(const LodTransition& transition, double t);

/// Which shape to draw so that nothing jumps: level `level` grown by `t` out of level `level + 1`. `t` is 1 where the
/// next level would not serve, falls to 0 within the band of the hysteresis below its limit, and the coarsest level has
/// t = 1 throughout.
struct LodBlend {
  std::size_t level = 0;
  double t = 1;
};
/// The blend for a body whose bounding box has a diagonal of so many pixels on the screen.
LodBlend blend_for_size(const LodChain& chain, double diagonal_px);

/// GEN-TESS: triangles of a mesh in percent of a plain tessellation of the points, which has two for each (thesis
/// 6.2.3).
double share_of_plain_tessellation_percent(std::size_t triangles, std::size_t points);

}  // namespace dynasurf::cloud
