#include "dynasurf/cloud/detail/open_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "dynasurf/cloud/detail/body.hpp"
#include "dynasurf/cloud/detail/facing.hpp"
#include "dynasurf/cloud/detail/patch.hpp"
#include "dynasurf/cloud/detail/triangle_marks.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/submesh.hpp"
#include "dynasurf/mesh/detail/vertex_normals.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::cloud {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Of each vertex to the points of the scan and of its holes.
std::vector<double> distances_to_points(const TriMesh& mesh, const std::vector<Vec3>& normals,
                                        const IndicatorField& field, const SupportingPoints& scan,
                                        const OrientedPoints& fill, double most) {
  std::vector<double> distances(mesh.vertices.size());
  const KdTree in_holes(fill.points);
  parallel_for(distances.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 &place = mesh.vertices[v], &normal = normals[v];
      distances[v] = distance_facing(scan.tree, place, normal, not_against, most,
                                     [&](std::uint32_t i) { return outwards(field, scan.points[i]); });
      if (fill.points.empty()) continue;
      const double in_hole =
          distance_facing(in_holes, place, normal, not_against, most, [&](std::uint32_t i) { return fill.normals[i]; });
      distances[v] = std::min(distances[v], in_hole);
    }
  });
  return distances;
}

/// Along every edge whose ends lie on both sides of the reach, the place where it passes it, and the direction there.
OrientedPoints passages(const TriMesh& mesh, const std::vector<Vec3>& normals, const std::vector<double>& distances,
                        double reach) {
  OrientedPoints passed;
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = t[c], b = t[(c + 1) % 3];
      if (!(distances[a] <= reach && distances[b] > reach)) continue;  // of two triangles one runs this way
      const double at = (reach - distances[a]) / (distances[b] - distances[a]);
      passed.points.push_back((1 - at) * mesh.vertices[a] + at * mesh.vertices[b]);
      passed.normals.push_back((normals[a] + normals[b]).normalized());
    }
  return passed;
}

/// Means over the neighbours, which take the teeth off the line where the values are 0.
void smooth(const TriMesh& mesh, std::vector<double>& values, int sweeps) {
  for (int k = 0; k < sweeps; ++k) {
    std::vector<double> sum(values.size(), 0), count(values.size(), 0);
    for (const auto& t : mesh.triangles)
      for (std::size_t c = 0; c < 3; ++c) {
        sum[t[c]] += values[t[(c + 1) % 3]];
        count[t[c]] += 1;
      }
    for (std::size_t v = 0; v < values.size(); ++v) values[v] = 0.5 * (values[v] + sum[v] / count[v]);
  }
}

/// Positive on what is to stay, at the vertices; nothing where all of it is.
std::optional<std::vector<double>> values_of_cut(const TriMesh& mesh, const IndicatorField& field,
                                                 const SupportingPoints& scan, const OrientedPoints& fill,
                                                 const OpenCut& cut) {
  constexpr int sweeps = 2;
  const std::vector<Vec3> normals = mesh::vertex_normals(mesh);
  const std::vector<double> distances = distances_to_points(mesh, normals, field, scan, fill, 2 * cut.reach);
  const OrientedPoints line = passages(mesh, normals, distances, cut.reach);
  if (line.points.empty()) return std::nullopt;
  const KdTree tree(line.points);
  const double back = cut.reach - cut.margin;
  std::vector<double> values(distances.size());
  parallel_for(values.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const double to_line = distance_facing(tree, mesh.vertices[v], normals[v], not_against, 3 * cut.reach,
                                             [&](std::uint32_t i) { return line.normals[i]; });
      values[v] = (distances[v] <= cut.reach ? to_line : -to_line) - back;
    }
  });
  smooth(mesh, values, sweeps);
  return values;
}

/// Cuts triangles along the line where the values at their vertices are 0.
class Split {
 public:
  Split(const TriMesh& mesh, std::vector<double> values) : mesh_(mesh), values_(std::move(values)) {
    settle_near_vertices();
    for (const auto& t : mesh.triangles) cut(t);
    mesh_.triangles = std::move(triangles_);
  }
  const TriMesh& mesh() const { return mesh_; }
  Marks positive;

 private:
  using Corners = std::array<std::uint32_t, 3>;

  bool is_passed(std::uint32_t a, std::uint32_t b) const { return values_[a] * values_[b] < 0; }

  /// Where the line passes within a hundredth of an edge from a vertex, it goes through it.
  void settle_near_vertices() {
    constexpr double near = 0.01;
    Marks settled(values_.size(), 0);
    for (const auto& t : mesh_.triangles)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t a = t[c], b = t[(c + 1) % 3];
        if (!is_passed(a, b)) continue;
        const double at = values_[a] / (values_[a] - values_[b]);
        if (at < near) settled[a] = 1;
        if (at > 1 - near) settled[b] = 1;
      }
    for (std::size_t v = 0; v < values_.size(); ++v)
      if (settled[v]) values_[v] = 0;
  }

  std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] = middles_.emplace(Edge(std::minmax(a, b)), values_.size());
    if (!is_new) return found->second;
    const auto [low, high] = found->first;  // the same place from both sides
    const double at = values_[low] / (values_[low] - values_[high]);
    const Vec3 place = (1 - at) * mesh_.vertices[low] + at * mesh_.vertices[high];
    mesh_.vertices.push_back(place);
    values_.push_back(0);
    return found->second;
  }

  void add(const Corners& t) {
    triangles_.push_back(t);
    double sum = 0;
    for (const std::uint32_t v : t) sum += values_[v];
    positive.push_back(sum > 0);
  }

  void cut(const Corners& t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = t[c], b = t[(c + 1) % 3], d = t[(c + 2) % 3];
      if (is_passed(a, b) && is_passed(a, d)) {  // one corner against two
        const std::uint32_t m = middle(a, b), n = middle(a, d);
        add({a, m, n});
        add({m, b, d});
        add({m, d, n});
        return;
      }
      if (is_passed(a, b) && values_[d] == 0) {
        const std::uint32_t m = middle(a, b);
        add({a, m, d});
        add({m, b, d});
        return;
      }
    }
    add(t);
  }

  TriMesh mesh_;
  std::vector<double> values_;
  std::vector<Corners> triangles_;
  std::map<Edge, std::uint32_t> middles_;
};

}  // namespace

OpenSurface open_surface(const IndicatorField& field, const SupportingPoints& scan, const OrientedPoints& fill,
                         const OpenCut& cut) {
  OpenSurface surface;
  surface.mesh = body_surface(field, 0, scan.points, cut.smallest_share);
  if (surface.mesh.triangles.empty()) return surface;
  if (const auto values = values_of_cut(surface.mesh, field, scan, fill, cut)) {
    Split split(surface.mesh, *values);
    drop_pinches(split.mesh(), split.positive);
    surface.mesh = mesh::submesh(split.mesh(), split.positive);
    if (surface.mesh.triangles.empty()) return surface;
    surface.mesh = without_small_parts(std::move(surface.mesh), scan.points, cut.smallest_share);
  }
  const mesh::Topology top = mesh::topology(surface.mesh);
  surface.parts = top.components;
  surface.loops = top.boundary_edges > 0 ? loops_of(surface.mesh).size() : 0;
  surface.genus = surface.parts - (top.euler + surface.loops) / 2;
  return surface;
}

}  // namespace dynasurf::cloud
