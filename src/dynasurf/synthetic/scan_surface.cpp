#include <algorithm>
#include <cmath>
#include <numeric>

#include "dynasurf/core/error.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::synthetic {
namespace {

enum Stream : std::uint64_t { places, noise, hole };

/// The largest area of triangles up to each one.
std::vector<double> areas_up_to(const TriMesh& surface) {
  std::vector<double> sums;
  double sum = 0;
  for (const auto& t : surface.triangles) {
    const Vec3& a = surface.vertices[t[0]];
    sum += 0.5 * (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a).norm();
    sums.push_back(sum);
  }
  if (!(sum > 0)) throw InputError("a surface without area cannot be scanned");
  return sums;
}

/// The points nearest to one of them go, in their own order.
void tear_hole(PointCloud& cloud, double share, Random random) {
  const std::size_t n = cloud.points.size(), gone = share * n;
  const std::size_t at = random.uniform() * n;
  const Vec3 middle = cloud.points[at];
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return (cloud.points[a] - middle).squaredNorm() < (cloud.points[b] - middle).squaredNorm();
  });
  order.erase(order.begin(), order.begin() + gone);
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) {
    cloud.points[i] = cloud.points[order[i]];
    if (!cloud.normals.empty()) cloud.normals[i] = cloud.normals[order[i]];
  }
  cloud.points.resize(order.size());
  if (!cloud.normals.empty()) cloud.normals.resize(order.size());
}

constexpr int usual_points = 100000, least_points = 10;

}  // namespace

PointCloud scan_surface(const TriMesh& surface, const CloudPhantom& options) {
  CloudPhantom o = options;
  check_options(o, "cloud");
  if (o.points == 0) o.points = thesis_points(o.shape) > 0 ? thesis_points(o.shape) : usual_points;
  if (o.points < least_points)
    throw OptionError("option cloud.points is " + std::to_string(o.points) + "; expected 0 or at least " +
                      std::to_string(least_points));
  const std::vector<double> sums = areas_up_to(surface);
  Eigen::AlignedBox3d box;
  for (const Vec3& p : surface.vertices) box.extend(p);
  const double sigma = o.noise_percent / 100 * box.diagonal().norm();
  PointCloud cloud;
  cloud.points.reserve(o.points);
  for (int n = 0; n < o.points; ++n) {
    Random where(o.seed, places, n), off(o.seed, noise, n);
    const double at = where.uniform() * sums.back();
    const std::size_t t = std::lower_bound(sums.begin(), sums.end(), at) - sums.begin();
    const Vec3& a = surface.vertices[surface.triangles[t][0]];
    const Vec3 ab = surface.vertices[surface.triangles[t][1]] - a, ac = surface.vertices[surface.triangles[t][2]] - a;
    double u = where.uniform(), v = where.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const double x = off.normal(), y = off.normal(), z = off.normal();
    cloud.points.push_back(a + u * ab + v * ac + sigma * Vec3(x, y, z));
    if (o.normals) cloud.normals.push_back(ab.cross(ac).normalized());
  }
  if (o.missing_percent > 0) tear_hole(cloud, o.missing_percent / 100, Random(o.seed, hole));
  return cloud;
}

PointCloud make_cloud(const CloudPhantom& options) { return scan_surface(cloud_reference(options.shape), options); }

}  // namespace dynasurf::synthetic
