#include "dynasurf/cloud/detail/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "dynasurf/cloud/detail/patch.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t samples_of_mesh = 50000;
constexpr std::size_t measure_grain = 2048;

double smallest_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c) {
  // By atan2: the arc cosine loses small angles to rounding.
  const auto angle = [](const Vec3& u, const Vec3& v) { return own::atan2(u.cross(v).norm(), u.dot(v)); };
  return std::min({angle(b - a, c - a), angle(c - b, a - b), angle(a - c, b - c)}) * 180 / std::numbers::pi;
}

void measure_angles(const TriMesh& mesh, Certificate& c) {
  if (mesh.triangles.empty()) return;
  std::vector<double> angles;
  angles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    angles.push_back(smallest_angle_deg(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  std::sort(angles.begin(), angles.end());
  const auto share = [&](double q) {
    const std::size_t rank = q * (angles.size() - 1);
    return angles[rank];
  };
  c.smallest_angle_deg = angles.front();
  c.angle_percentile_1_deg = share(0.01);
  c.angle_percentile_5_deg = share(0.05);
  for (const double a : angles) c.angle_mean_deg += a / angles.size();
}

/// The vertices, and points that follow the area evenly: triangle after triangle, by the R2 sequence within each.
std::vector<Vec3> spread_over(const TriMesh& mesh, double area) {
  std::vector<Vec3> points = mesh.vertices;
  if (!(area > 0)) return points;
  const double per_area = samples_of_mesh / area;
  double owed = 0;
  std::size_t n = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    for (owed += 0.5 * (b - a).cross(c - a).norm() * per_area; owed >= 1; owed -= 1) {
      double whole = 0;
      ++n;
      double u = std::modf(0.7548776662466927 * n, &whole);
      double v = std::modf(0.5698402909980532 * n, &whole);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      points.push_back(a + u * (b - a) + v * (c - a));
    }
  }
  return points;
}

struct Spread {
  double mean = 0, largest = 0;
  void add(double distance, std::size_t count) {
    mean += distance / count;
    largest = std::max(largest, distance);
  }
};

/// The nearest places of the cloud's points, one after the other.
template <class Visit>
void visit_nearest(const TriMesh& mesh, std::span<const Vec3> points, const Visit& visit) {
  constexpr std::size_t block = std::size_t{1} << 16;  // bounds the memory
  const mesh::ClosestPoint closest(mesh);
  std::vector<mesh::SurfacePoint> found(std::min(block, points.size()));
  for (std::size_t done = 0; done < points.size(); done += block) {
    const std::size_t count = std::min(block, points.size() - done);
    parallel_for(count, measure_grain, [&](std::size_t begin, std::size_t end) {
      std::uint32_t guess = mesh::SurfacePoint::none;  // near points lie near the same triangle
      for (std::size_t i = begin; i < end; ++i) {
        found[i] = closest.from_guess(points[done + i], guess);
        guess = found[i].triangle;
      }
    });
    for (std::size_t i = 0; i < count; ++i) visit(found[i]);
  }
}

/// Gathered in the order of the points, so that the sums are the same for any number of threads.
Spread spread_of_cloud(const TriMesh& mesh, std::span<const Vec3> points, std::vector<float>& errors) {
  Spread spread;
  std::vector<double> sum(mesh.vertices.size(), 0), weight(mesh.vertices.size(), 0);
  visit_nearest(mesh, points, [&](const mesh::SurfacePoint& p) {
    const double distance = std::sqrt(p.distance2);
    spread.add(distance, points.size());
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t v = mesh.triangles[p.triangle][corner];
      sum[v] += p.weights[corner] * distance;
      weight[v] += p.weights[corner];
    }
  });
  for (std::size_t v = 0; v < errors.size(); ++v)
    if (weight[v] > 1e-9) errors[v] = sum[v] / weight[v];
  return spread;
}

Spread spread_of_mesh(const std::vector<Vec3>& points, const KdTree& cloud) {
  std::vector<double> distances(points.size());
  parallel_for(distances.size(), measure_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) distances[i] = std::sqrt(cloud.nearest(points[i]).distance2);
  });
  Spread spread;
  for (const double d : distances) spread.add(d, distances.size());
  return spread;
}

}  // namespace

Comparison compare(const TriMesh& mesh, const KdTree& cloud) {
  const TraceStage noted("levels: certificate");
  Comparison result;
  Certificate& c = result.certificate;
  const mesh::SurfaceCheck check = mesh::check_surface(mesh);
  const mesh::Topology top = mesh::topology(mesh);
  c.vertices = mesh.vertices.size();
  c.triangles = mesh.triangles.size();
  c.closed = check.closed;
  c.manifold = check.manifold;
  c.oriented = check.oriented;
  c.self_intersections = check.self_intersections;
  c.flat_triangles = check.flat_triangles;
  c.components = top.components;
  if (c.manifold && c.oriented && !mesh.triangles.empty()) {
    c.boundary_loops = c.closed ? 0 : loops_of(mesh).size();
    // From V - E + F = 2 (components - genus) - loops.
    c.genus = top.components - (top.euler + c.boundary_loops) / 2;
  }
  measure_angles(mesh, c);
  c.volume = mesh::volume_mm3(mesh);
  c.area = mesh::area_mm2(mesh);
  c.outward = c.volume > 0;
  result.errors.assign(mesh.vertices.size(), -1);
  if (cloud.points().empty() || mesh.triangles.empty()) return result;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points()) box.extend(p);
  c.cloud_diagonal = box.diagonal().norm();
  const Spread there = spread_of_cloud(mesh, cloud.points(), result.errors);
  const Spread back = spread_of_mesh(spread_over(mesh, c.area), cloud);
  c.cloud_to_mesh_mean = there.mean;
  c.cloud_to_mesh_largest = there.largest;
  c.mesh_to_cloud_mean = back.mean;
  c.mesh_to_cloud_largest = back.largest;
  return result;
}

Certificate certify(const TriMesh& mesh, const PointCloud& cloud) {
  for (const Vec3& p : cloud.points)
    if (!p.allFinite()) throw InputError("certificate: the cloud has a point that is not finite");
  return compare(mesh, KdTree(cloud.points)).certificate;
}

}  // namespace dynasurf::cloud
