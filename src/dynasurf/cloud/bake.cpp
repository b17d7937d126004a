#include "dynasurf/cloud/detail/bake.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/cloud/detail/light.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/vertex_normals.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t points_per_texel = 6;

/// Squares of `side` texels, `across` of them in a row, two triangles in each: one with its right angle at the top
/// left, one with it at the bottom right, four texels between their long sides.
struct Atlas {
  std::size_t side, across, rows;

  std::size_t width() const { return side * across; }
  std::size_t height() const { return side * rows; }
  double leg() const { return side - 4.0; }

  /// Where a corner stands, in texels.
  Eigen::Vector2d place(std::size_t triangle, std::size_t corner) const {
    const std::size_t square = triangle / 2;
    const std::size_t column = square % across, row = square / across;
    const Eigen::Vector2d origin(1.0 * column * side, 1.0 * row * side);
    Eigen::Vector2d within(1 + (corner == 1 ? leg() : 0), 1 + (corner == 2 ? leg() : 0));
    if (triangle % 2 == 1) within = Eigen::Vector2d::Constant(side) - within;
    return origin + within;
  }

  /// The triangle that a texel belongs to, and the weights of its corners at the texel's middle, or at the nearest
  /// place of the triangle for texels around it.
  std::pair<std::size_t, Vec3> at(std::size_t x, std::size_t y) const {
    double u = (x % side) + 0.5, v = (y % side) + 0.5;
    const bool second = u + v > side;
    if (second) {
      u = side - u;
      v = side - v;
    }
    u = std::max((u - 1) / leg(), 0.0);
    v = std::max((v - 1) / leg(), 0.0);
    const double sum = std::max(u + v, 1.0);
    u /= sum;
    v /= sum;
    return {2 * (y / side * across + x / side) + (second ? 1 : 0), {1 - u - v, u, v}};
  }
};

Atlas atlas_for(std::size_t triangles, std::size_t points) {
  Atlas atlas{};
  const double per_triangle = 1.0 * points / triangles;
  atlas.side = std::clamp(std::ceil(2 * std::sqrt(per_triangle)) + 4, 8.0, 40.0);
  const std::size_t squares = (triangles + 1) / 2;
  atlas.across = std::ceil(std::sqrt(squares));
  atlas.rows = (squares + atlas.across - 1) / atlas.across;
  return atlas;
}

/// A unit vector at right angles to `normal`, as close to `along` as can be.
Vec3 tangent_to(const Vec3& normal, const Vec3& along) {
  const Vec3 tangent = along - normal * normal.dot(along);
  return tangent.stableNorm() > 1e-9 * along.stableNorm() ? Vec3(tangent.stableNormalized()) : normal.unitOrthogonal();
}

std::vector<mesh::TexturedMesh::Corner> corners_of(const TriMesh& mesh, const Atlas& atlas) {
  std::vector<Vec3> normals = mesh::vertex_normals(mesh);
  for (Vec3& n : normals)
    if (n.isZero()) n = Vec3::UnitZ();
  std::vector<mesh::TexturedMesh::Corner> corners;
  corners.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const Vec3 along = mesh.vertices[triangle[1]] - mesh.vertices[triangle[0]];
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector2d place = atlas.place(t, i);
      const Vec3& normal = normals[triangle[i]];
      const float u = place[0] / atlas.width(), v = place[1] / atlas.height();
      corners.push_back(
          {mesh.vertices[triangle[i]], normal.cast<float>(), tangent_to(normal, along).cast<float>(), {u, v}});
    }
  }
  return corners;
}

std::array<std::uint8_t, 3> encoded(const Vec3& direction) {
  std::array<std::uint8_t, 3> bytes{};
  for (int axis = 0; axis < 3; ++axis)
    bytes[axis] = std::lround(std::clamp(direction[axis] * 0.5 + 0.5, 0.0, 1.0) * 255);
  return bytes;
}

/// What the points say at one place of the surface.
class Baker {
 public:
  explicit Baker(const PointCloud& cloud) : cloud_(cloud), neighbours_(cloud.points), linear_(linear_light()) {}

  void bake(const Vec3& place, const Vec3& normal, const Vec3& tangent, std::array<std::uint8_t, 3>& direction,
            std::array<std::uint8_t, 3>* colour) const {
    std::array<KdTree::Found, points_per_texel> found;
    const std::size_t count = neighbours_.nearest(place, found);
    Vec3 sum(0, 0, 0), light(0, 0, 0);
    double facing = 0;
    for (std::size_t n = 0; n < count; ++n) {
      const Vec3 seen = cloud_.normals[found[n].index].stableNormalized();
      if (!(seen.dot(normal) > 0)) continue;
      sum += seen;
      facing += 1;
      if (colour == nullptr) continue;
      for (std::size_t c = 0; c < 3; ++c) light[c] += linear_[cloud_.colours[found[n].index][c]];
    }
    const Vec3 shown = sum.norm() > 0 ? Vec3(sum.normalized()) : normal;
    direction = encoded({shown.dot(tangent), shown.dot(normal.cross(tangent)), shown.dot(normal)});
    if (colour == nullptr) return;
    if (!(facing > 0)) {  // all points face away: the nearest of them is better than none
      *colour = cloud_.colours[found[0].index];
      return;
    }
    for (std::size_t c = 0; c < 3; ++c) (*colour)[c] = srgb_byte(light[c] / facing);
  }

 private:
  const PointCloud& cloud_;
  KdTree neighbours_;
  std::array<double, 256> linear_;
};

}  // namespace

mesh::TexturedMesh bake_textures(const TriMesh& mesh, const PointCloud& cloud) {
  if (mesh.triangles.empty()) throw InputError("textures for a mesh without triangles");
  if (cloud.points.empty() || cloud.normals.size() != cloud.points.size())
    throw InputError("textures from a cloud without a normal for each point");
  const Atlas atlas = atlas_for(mesh.triangles.size(), cloud.points.size());
  const int width = atlas.width(), height = atlas.height();
  mesh::TexturedMesh out;
  out.corners = corners_of(mesh, atlas);
  out.normals = {width, height, {}};
  // Flat where no triangle is.
  out.normals.texels.assign(atlas.width() * atlas.height(), {128, 128, 255});
  const bool coloured = !cloud.colours.empty();
  if (coloured) out.colours = {width, height, {}};
  if (coloured) out.colours.texels.assign(out.normals.texels.size(), {0, 0, 0});

  const Baker baker(cloud);
  parallel_for(atlas.height(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < atlas.width(); ++x) {
        const auto [triangle, weight] = atlas.at(x, y);
        if (triangle >= mesh.triangles.size()) continue;
        Vec3 place(0, 0, 0), normal(0, 0, 0), along(0, 0, 0);
        for (std::size_t i = 0; i < 3; ++i) {
          const mesh::TexturedMesh::Corner& corner = out.corners[3 * triangle + i];
          const double w = weight[i];
          place += w * corner.position;
          normal += w * corner.normal.cast<double>();
          along += w * corner.tangent.cast<double>();
        }
        normal = normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3::UnitZ();
        const std::size_t texel = y * atlas.width() + x;
        baker.bake(place, normal, tangent_to(normal, along), out.normals.texels[texel],
                   coloured ? &out.colours.texels[texel] : nullptr);
      }
  });
  return out;
}

}  // namespace dynasurf::cloud
