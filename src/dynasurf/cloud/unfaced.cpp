#include "dynasurf/cloud/detail/unfaced.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/detail/sample_surface.hpp"
#include "dynasurf/mesh/detail/vertex_normals.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t samples = 20000, grain = 256;
constexpr double alike = 0.5;  // cosine between directions

template <class Of>
std::vector<Vec3> places_of(const Of& those) {
  std::vector<Vec3> places;
  places.reserve(those.size());
  for (const auto& t : those) places.push_back(t.place);
  return places;
}

struct Finding {
  double points = 0;  // that a sample ought to hold where none faces its way; 0: one does
  float confidence = 1;
};

class Search {
 public:
  Search(std::span<const Foot> feet, double spacing, double noise)
      : feet_(feet), tree_(places_of(feet)), spacing_(spacing), noise_(noise) {}

  /// Of a sample that stands for `area`. Most have a foot that faces their way among the nearest few.
  Finding at(const Vec3& place, const Vec3& normal, double area) const {
    std::array<KdTree::Found, 64> found;
    constexpr std::size_t few = 4;
    if (facing(place, normal, {found.data(), few}) <= reach(found[0], 1)) return {};
    const double distance = facing(place, normal, found), sparseness = sparseness_around(found[0]);
    if (distance <= reach(found[0], sparseness)) return {};
    const double side = sparseness * spacing_, supported = 3 * (side + noise_);
    const double away = std::isfinite(distance) ? distance : std::max(2 * supported, farthest(found));
    return {area / (side * side), static_cast<float>(supported / away)};
  }

 private:
  /// Of the nearest feet the first that faces the same way; infinite when none of them does.
  double facing(const Vec3& place, const Vec3& normal, std::span<KdTree::Found> found) const {
    const std::size_t n = tree_.nearest(place, found);
    for (std::size_t k = 0; k < n; ++k)
      if (feet_[found[k].index].normal.dot(normal) > alike) return std::sqrt(found[k].distance2);
    return INFINITY;
  }

  double reach(const KdTree::Found& nearest, double sparseness) const {
    return 3 * (sparseness * spacing_ + noise_) + std::sqrt(nearest.distance2);
  }

  double farthest(std::span<const KdTree::Found> found) const {
    return std::sqrt(found[std::min(found.size(), feet_.size()) - 1].distance2);
  }

  /// How many times farther apart than usual the points are around a foot, from 1 to 4; on a rim, where they lie on one
  /// side of it, not more than elsewhere.
  double sparseness_around(const KdTree::Found& foot) const {
    const double side = spacing_around(tree_, feet_[foot.index].place) / std::numbers::sqrt2;
    return std::clamp(side / spacing_, 1.0, 4.0);
  }

  std::span<const Foot> feet_;
  KdTree tree_;
  double spacing_, noise_;
};

/// For each place the first of its part: places nearer than `apart` belong together.
std::vector<std::size_t> parts_of(const std::vector<Vec3>& places, double apart) {
  std::vector<std::size_t> part(places.size());
  std::iota(part.begin(), part.end(), std::size_t{0});
  const auto first_of = [&](std::size_t i) {
    while (part[i] != i) i = part[i] = part[part[i]];
    return i;
  };
  const KdTree tree(places);
  std::array<KdTree::Found, 24> found;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::size_t n = tree.nearest(places[i], found, apart);
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t a = first_of(i), b = first_of(found[k].index);
      part[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = first_of(i);
  return part;
}

}  // namespace

UnfacedParts unfaced_parts(const TriMesh& mesh, std::span<const Foot> feet, double spacing, double noise) {
  UnfacedParts parts;
  const std::vector<mesh::SurfaceSample> sampled = mesh::sample_surface(mesh, samples);
  if (sampled.empty() || feet.empty() || !(spacing > 0)) return parts;
  const double area = mesh::area_mm2(mesh) / sampled.size();
  const Search search(feet, spacing, noise);
  std::vector<Finding> findings(sampled.size());
  parallel_for(sampled.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      findings[i] = search.at(mesh::position_of(mesh, sampled[i]), normal_of(mesh, sampled[i].triangle), area);
  });

  std::vector<UnfacedPlace> places;
  std::vector<double> points;
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    if (findings[i].points == 0) continue;
    places.push_back(
        {mesh::position_of(mesh, sampled[i]), normal_of(mesh, sampled[i].triangle), findings[i].confidence});
    points.push_back(findings[i].points);
  }
  if (places.empty()) return parts;
  const std::vector<std::size_t> part = parts_of(places_of(places), 3 * std::sqrt(area));
  std::vector<double> sum(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) sum[part[i]] += points[i];
  parts.around = 2 * spacing;
  for (std::size_t i = 0; i < places.size(); ++i) {
    parts.points = std::max(parts.points, sum[i]);
    if (sum[part[i]] >= UnfacedParts::fewest_points) parts.places.push_back(places[i]);
  }
  return parts;
}

void doubt_unfaced(const UnfacedParts& parts, const TriMesh& mesh, std::span<float> confidence) {
  if (parts.places.empty()) return;
  const KdTree tree(places_of(parts.places));
  const std::vector<Vec3> normals = mesh::angle_weighted_normals(mesh);
  parallel_for(mesh.vertices.size(), grain, [&](std::size_t begin, std::size_t end) {
    std::array<KdTree::Found, 8> found;
    for (std::size_t v = begin; v < end; ++v) {
      const std::size_t n = tree.nearest(mesh.vertices[v], found, parts.around);
      for (std::size_t k = 0; k < n; ++k) {
        const UnfacedPlace& p = parts.places[found[k].index];
        if (p.normal.dot(normals[v]) > alike) confidence[v] = std::min(confidence[v], p.confidence);
      }
    }
  });
}

}  // namespace dynasurf::cloud
