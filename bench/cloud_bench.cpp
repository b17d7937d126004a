// Scanned bodies of 100,000 points without normals, from points to one mesh of 5120 triangles, in memory; beside it,
// where they are installed, CGAL (alpha wrap, then edges collapsed) and Open3D (Poisson, then decimated).
//
//     build/bench/bin/cloud_bench --benchmark_repetitions=5 --benchmark_enable_random_interleaving=true
//
// Counters: `off` is the mean distance of the points from the mesh, in percent of the diagonal of their box.
#include <array>
#include <cmath>

#include <benchmark/benchmark.h>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#ifdef DYNASURF_BENCH_CGAL
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/alpha_wrap_3.h>
#endif
#ifdef DYNASURF_BENCH_OPEN3D
#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>
#endif

namespace dynasurf {
namespace {

using synthetic::CloudShape;

constexpr int triangles = 5120;
constexpr std::array bodies{CloudShape::vase, CloudShape::spring, CloudShape::rabbit};

PointCloud scan(const benchmark::State& state) {
  return synthetic::make_cloud({.shape = bodies.at(static_cast<std::size_t>(state.range(0)))});
}

double diagonal(const PointCloud& cloud) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points) box.extend(p);
  return box.diagonal().norm();
}

void tell(benchmark::State& state, const PointCloud& cloud, const TriMesh& mesh) {
  const mesh::ClosestPoint closest(mesh);
  double sum = 0;
  for (const Vec3& p : cloud.points) sum += std::sqrt(closest(p).distance2);
  state.counters["off"] = 100 * sum / static_cast<double>(cloud.points.size()) / diagonal(cloud);
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.SetLabel(std::string(names_of(CloudShape{})[static_cast<std::size_t>(bodies.at(state.range(0)))]));
}

void cloud_to_mesh(benchmark::State& state) {
  const PointCloud points = scan(state);
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  cloud::Options options;
  options.triangles = {triangles};
  TriMesh mesh;
  for (auto _ : state) mesh = cloud::reconstruct(points, options).levels.front().mesh;
  tell(state, points, mesh);
}
BENCHMARK(cloud_to_mesh)
    ->ArgsProduct({{0, 1, 2}, {1, 2}})
    ->ArgNames({"body", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

#ifdef DYNASURF_BENCH_CGAL
void cgal_alpha_wrap(benchmark::State& state) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  using Mesh = CGAL::Surface_mesh<Point>;
  const PointCloud points = scan(state);
  std::vector<Point> places;
  for (const Vec3& p : points.points) places.emplace_back(p[0], p[1], p[2]);
  const double alpha = diagonal(points) / 100;
  Mesh wrap;
  for (auto _ : state) {
    wrap.clear();
    CGAL::alpha_wrap_3(places, alpha, alpha / 30, wrap);
    namespace simplification = CGAL::Surface_mesh_simplification;
    simplification::edge_collapse(wrap, simplification::Count_stop_predicate<Mesh>(3 * triangles / 2));
    wrap.collect_garbage();
  }
  TriMesh mesh;
  for (const auto v : wrap.vertices()) {
    const Point& p = wrap.point(v);
    mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : wrap.faces()) {
    std::array<std::uint32_t, 3> corners{};
    std::size_t n = 0;
    for (const auto v : wrap.vertices_around_face(wrap.halfedge(f))) corners.at(n++) = v.idx();
    mesh.triangles.push_back(corners);
  }
  tell(state, points, mesh);
}
BENCHMARK(cgal_alpha_wrap)->DenseRange(0, 2)->ArgName("body")->UseRealTime()->Unit(benchmark::kMillisecond);
#endif

#ifdef DYNASURF_BENCH_OPEN3D
void open3d_poisson(benchmark::State& state) {
  const PointCloud points = scan(state);
  std::shared_ptr<open3d::geometry::TriangleMesh> found;
  for (auto _ : state) {
    open3d::geometry::PointCloud cloud(points.points);
    cloud.EstimateNormals(open3d::geometry::KDTreeSearchParamKNN(30));
    cloud.OrientNormalsConsistentTangentPlane(15);
    found = std::get<0>(open3d::geometry::TriangleMesh::CreateFromPointCloudPoisson(cloud, 8));
    found = found->SimplifyQuadricDecimation(triangles, std::numeric_limits<double>::infinity(), 1);
  }
  TriMesh mesh{found->vertices_, {}};
  for (const Eigen::Vector3i& t : found->triangles_)
    mesh.triangles.push_back(
        {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]), static_cast<std::uint32_t>(t[2])});
  tell(state, points, mesh);
}
BENCHMARK(open3d_poisson)->DenseRange(0, 2)->ArgName("body")->UseRealTime()->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace dynasurf
