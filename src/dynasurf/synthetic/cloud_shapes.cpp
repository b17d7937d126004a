#include "dynasurf/synthetic/cloud_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/synthetic/detail/level_bodies.hpp"
#include "dynasurf/synthetic/detail/solids.hpp"

namespace dynasurf::synthetic {
namespace {

using std::numbers::pi;
using Level = std::function<double(const Vec3&)>;  // positive inside

constexpr std::array<std::string_view, 14> names{"sphere",      "ellipsoid", "torus", "two_torus", "cube",
                                                 "plate",       "spring",    "vase",  "blobs",     "rabbit",
                                                 "screwdriver", "venus",     "moai",  "squirrel"};

TriMesh stretched(TriMesh mesh, const Vec3& half_axes) {
  for (Vec3& p : mesh.vertices) p = p.cwiseProduct(half_axes);
  return mesh;
}

/// Rings of points joined to a tube; the first ring follows the last one, or points close both ends.
TriMesh tube(int rings, int sides, bool is_ring, const std::function<Vec3(int, int)>& at, const Vec3& start = {},
             const Vec3& end = {}) {
  TriMesh mesh;
  const auto id = [&](int r, int s) -> std::uint32_t { return (r % rings) * sides + s % sides; };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < sides; ++s) mesh.vertices.push_back(at(r, s));
  for (int r = 0; r < (is_ring ? rings : rings - 1); ++r)
    for (int s = 0; s < sides; ++s) {
      mesh.triangles.push_back({id(r, s), id(r + 1, s), id(r + 1, s + 1)});
      mesh.triangles.push_back({id(r, s), id(r + 1, s + 1), id(r, s + 1)});
    }
  if (is_ring) return mesh;
  const std::uint32_t first = mesh.vertices.size();
  mesh.vertices.push_back(start);
  mesh.vertices.push_back(end);
  for (int s = 0; s < sides; ++s) {
    mesh.triangles.push_back({first, id(0, s), id(0, s + 1)});
    mesh.triangles.push_back({first + 1, id(rings - 1, s + 1), id(rings - 1, s)});
  }
  return mesh;
}

TriMesh torus(double large, double small) {
  constexpr int rings = 256, sides = 96;
  return tube(rings, sides, true, [&](int r, int s) {
    const double u = 2 * pi * r / rings, v = 2 * pi * s / sides, across = large + small * own::cos(v);
    return Vec3(across * own::cos(u), across * own::sin(u), small * own::sin(v));
  });
}

/// Two and a half turns of a wire with round ends.
TriMesh spring() {
  constexpr int body = 600, cap = 16, rings = body + 2 * cap + 1, sides = 48;
  constexpr double turns = 2.5, radius = 0.8, rise = 0.6, wire = 0.16;
  const auto frame = [&](double u, Vec3& out, Vec3& up) {
    const double angle = 2 * pi * u;
    Vec3 along = Vec3(-2 * pi * radius * own::sin(angle), 2 * pi * radius * own::cos(angle), rise).normalized();
    out = Vec3(own::cos(angle), own::sin(angle), 0);
    up = along.cross(out);
    return along;
  };
  const auto centre = [&](double u) {
    return Vec3(radius * own::cos(2 * pi * u), radius * own::sin(2 * pi * u), rise * (u - turns / 2));
  };
  const auto at = [&](int r, int s) {
    const double u = turns * std::clamp(r - cap, 0, body) / body;
    const int beyond = r - cap - std::clamp(r - cap, 0, body);
    const double tilt = 0.5 * pi * beyond / (cap + 1.0);
    Vec3 out, up;
    const Vec3 along = frame(u, out, up);
    const double v = 2 * pi * s / sides;
    return Vec3(centre(u) + wire * (own::sin(tilt) * along + own::cos(tilt) * (own::cos(v) * out - own::sin(v) * up)));
  };
  Vec3 out, up;
  const Vec3 start = centre(0) - wire * frame(0, out, up), end = centre(turns) + wire * frame(turns, out, up);
  return tube(rings, sides, false, at, start, end);
}

/// A belly with a narrow neck, hollow almost to the foot.
TriMesh vase() {
  std::vector<ProfilePoint> profile;
  const auto outer = [](double z) { return 0.36 + 0.24 * own::cos(2.4 * z + 0.9) + 0.05 * z; };
  constexpr double wall = 0.07, foot = -1, rim = 1;
  constexpr int steps = 160;
  profile.push_back({0, foot});
  for (int i = 1; i < 20; ++i) profile.push_back({outer(foot) * i / 20, foot});
  for (int i = 0; i <= steps; ++i) {
    const double z = foot + (rim - foot) * i / steps;
    profile.push_back({outer(z), z});
  }
  for (int i = 1; i < 12; ++i) {  // the rim is a half circle
    const double a = pi * i / 12;
    profile.push_back({outer(rim) - wall / 2 + wall / 2 * own::cos(a), rim + wall / 2 * own::sin(a)});
  }
  for (int i = steps; i >= 8; --i) {
    const double z = foot + (rim - foot) * i / steps;
    profile.push_back({outer(z) - wall, z});
  }
  const double floor = foot + (rim - foot) * 8.0 / steps, inner = outer(floor) - wall;
  for (int i = 19; i > 0; --i) profile.push_back({inner * i / 20, floor});
  profile.push_back({0, floor});
  return revolve(profile, 160);
}

/// The surface where `level` is 0, in the box [-extent, extent]^3.
TriMesh level_surface(const Level& level, double extent) {
  constexpr int cells = 128;
  Image image(Grid{.dims = {cells, cells, cells}});
  const double side = 2 * extent / (cells - 1);
  const auto place = [&](const Vec3& grid) { return Vec3(side * grid - Vec3::Constant(extent)); };
  for (int k = 0; k < cells; ++k)
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i) image(i, j, k) = level(place(Vec3(i, j, k)));
  TriMesh mesh = mesh::marching_cubes(image, 0);
  for (Vec3& p : mesh.vertices) {
    p = place(p);
    // Marching cubes interpolates linearly; Newton steps bring its vertices onto the surface itself.
    for (int n = 0; n < 3; ++n) {
      constexpr double h = 1e-4;
      Vec3 slope;
      for (int a = 0; a < 3; ++a) slope[a] = (level(p + h * Vec3::Unit(a)) - level(p - h * Vec3::Unit(a))) / (2 * h);
      // No vertex leaves its cell: neighbours keep their order.
      const Vec3 step = -level(p) / std::max(slope.squaredNorm(), 1e-9) * slope;
      p += step * std::min(1.0, 0.1 * side / std::max(step.norm(), 1e-12));
    }
  }
  return mesh;
}

double two_torus(const Vec3& p) {
  const double x = p[0], y = p[1], z = p[2];
  const double lemniscate = x * x * (1 - x * x) - y * y;
  return 0.02 - lemniscate * lemniscate - 0.5 * z * z;
}

double blobs(const Vec3& p) {
  struct Blob {
    double x, y, z, radius;
  };
  constexpr std::array<Blob, 6> all{{{0, 0, 0, 0.5},
                                     {0.55, 0.1, 0.1, 0.3},
                                     {-0.5, 0.3, -0.1, 0.34},
                                     {-0.1, -0.6, 0.2, 0.28},
                                     {0.15, 0.2, 0.62, 0.22},
                                     {-0.2, 0.15, -0.6, 0.18}}};
  double sum = -1;
  for (const Blob& b : all) {
    const double d2 = (p - Vec3(b.x, b.y, b.z)).squaredNorm() / (b.radius * b.radius);
    sum += own::exp(1.5 * (1 - d2)) / 1.5;
  }
  return sum;
}

}  // namespace

std::span<const std::string_view> names_of(CloudShape) { return names; }

TriMesh cloud_reference(CloudShape shape) {
  switch (shape) {
    case CloudShape::sphere:
      return mesh::icosphere(6);
    case CloudShape::ellipsoid:
      return stretched(mesh::icosphere(6), {1, 0.6, 0.35});
    case CloudShape::torus:
      return torus(0.75, 0.25);
    case CloudShape::two_torus:
      return level_surface(two_torus, 1.3);
    case CloudShape::cube:
      return mesh::cube_surface(50);
    case CloudShape::plate:
      return stretched(mesh::cube_surface(50), {1, 0.7, 0.03});
    case CloudShape::spring:
      return spring();
    case CloudShape::vase:
      return vase();
    case CloudShape::blobs:
      return level_surface(blobs, 1.3);
    case CloudShape::rabbit:
      return level_surface(rabbit_level, 1.3);
    case CloudShape::screwdriver:
      return level_surface(screwdriver_level, 1.3);
    case CloudShape::venus:
      return level_surface(venus_level, 1.3);
    case CloudShape::moai:
      return level_surface(moai_level, 1.3);
    case CloudShape::squirrel:
      return level_surface(squirrel_level, 1.3);
  }
  return {};
}

int thesis_points(CloudShape shape) {
  switch (shape) {
    case CloudShape::rabbit:
      return 67038;
    case CloudShape::screwdriver:
      return 27152;
    case CloudShape::vase:
      return 68097;
    case CloudShape::venus:
      return 134345;
    case CloudShape::moai:
      return 10002;
    case CloudShape::squirrel:
      return 9996;
    default:
      return 0;
  }
}

int genus_of(CloudShape shape) { return shape == CloudShape::torus ? 1 : shape == CloudShape::two_torus ? 2 : 0; }

}  // namespace dynasurf::synthetic
