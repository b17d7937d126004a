#pragma once
#include <cstdint>
#include <span>
#include <string_view>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::synthetic {

/// Bodies that try what a reconstruction of clouds can do: round, with one and two handles, with sharp edges, thin,
/// winding, with a deep cavity, of many curvatures; and the likes of the six bodies of the thesis (6.2.3, table 6.18),
/// vase among them, whose scans are not published.
enum class CloudShape {
  sphere,
  ellipsoid,
  torus,
  two_torus,
  cube,
  plate,
  spring,
  vase,
  blobs,
  rabbit,
  screwdriver,
  venus,
  moai,
  squirrel
};
std::span<const std::string_view> names_of(CloudShape);

/// The surface of a body: closed, oriented outwards, free of self-intersections, fine enough (10,000 to 200,000
/// triangles) to stand for the body itself. About 2 in size.
TriMesh cloud_reference(CloudShape shape);
/// How many handles it has.
int genus_of(CloudShape shape);
/// How many points the thesis had of a body of this name; 0 for those that it had not.
int thesis_points(CloudShape shape);

/// A scan of a surface: points drawn evenly by area, and what goes wrong with them.
struct CloudPhantom {
  CloudShape shape = CloudShape::sphere;
  int points = 100000;
  double noise_percent = 0;
  double missing_percent = 0;
  bool normals = false;
  std::uint64_t seed = 1;
};
void describe(auto& visit, CloudPhantom& o) {
  visit("shape", o.shape, OptionInfo{"the body that is scanned"});
  visit(
      "points", o.points,
      OptionInfo{"points before any go missing; 0: as many as the thesis had of rabbit, screwdriver, vase, venus, moai "
                 "and squirrel, 100000 of others",
                 "", 0, 1e8});
  visit("noise_percent", o.noise_percent,
        OptionInfo{"standard deviation of a normal displacement in every direction", "% of the bounding box's diagonal",
                   0, 100});
  visit("missing_percent", o.missing_percent,
        OptionInfo{"share of the points that is missing, in one region around a point of the surface", "%", 0, 90});
  visit("normals", o.normals, OptionInfo{"give the points the normals of the surface they come from"});
  visit("seed", o.seed, OptionInfo{"the same seed gives the same points"});
}

/// `options.shape` is not asked: the points come from `surface`. Throws InputError for a surface without area.
PointCloud scan_surface(const TriMesh& surface, const CloudPhantom& options);
PointCloud make_cloud(const CloudPhantom& options);

}  // namespace dynasurf::synthetic
