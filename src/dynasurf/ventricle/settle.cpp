#include "dynasurf/ventricle/detail/settle.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/mesh/detail/vertex_normals.hpp"
#include "dynasurf/mesh/smooth.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr int samples_per_voxel = 3;
constexpr double lid_cosine = 0.5;  // normals nearer to the base belong to the lid
constexpr double weak_slope = 0.2;  // of the median slope: what lies below is no border
constexpr double no_slope = 1e-6;   // of the image's largest value per sample: rounding alone

/// Slopes of the image along the normals: a row per vertex, its middle on the vertex.
struct Profiles {
  std::size_t width = 0;
  double step_mm = 0;
  std::vector<double> slopes;

  std::span<double> of(std::size_t vertex) { return std::span(slopes).subspan(vertex * width, width); }
  std::span<const double> of(std::size_t vertex) const { return std::span(slopes).subspan(vertex * width, width); }
};

Profiles profiles_of(const TriMesh& mesh, const std::vector<Vec3>& normals, const Image& image, double reach_voxels) {
  const int reach = ceil_int(reach_voxels * samples_per_voxel) + 1;
  Profiles p;
  p.width = 2 * reach + 1;
  p.step_mm = image.grid.spacing.minCoeff() / samples_per_voxel;
  p.slopes.resize(mesh.vertices.size() * p.width);
  std::vector<double> values(p.width + 2);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (int s = 0; s < std::ssize(values); ++s)
      values[s] = image::sample_cubic(image, mesh.vertices[v] + (s - reach - 1) * p.step_mm * normals[v]);
    const std::span<double> row = p.of(v);
    for (std::size_t s = 0; s < row.size(); ++s) row[s] = (values[s + 2] - values[s]) / (2 * p.step_mm);
  }
  return p;
}

/// Walls are bright: an outer surface has the image fall outwards, an inner one has it rise. Slopes in the direction of
/// most of the surface become positive.
void turn_upwards(Profiles& p, const std::vector<bool>& on_lid) {
  double sum = 0;
  for (std::size_t v = 0; v < on_lid.size(); ++v)
    if (!on_lid[v]) sum += p.of(v)[p.width / 2];
  if (sum >= 0) return;
  for (double& slope : p.slopes) slope = -slope;
}

/// Half a vertex's own slopes, half the mean of its neighbours'.
Profiles averaged(const Profiles& p, const mesh::VertexRings& rings, const std::vector<bool>& on_lid) {
  Profiles result = p;
  for (std::uint32_t v = 0; v < on_lid.size(); ++v) {
    const std::span<double> row = result.of(v);
    double count = 0;
    std::vector<double> sum(p.width, 0.0);
    for (const std::uint32_t u : rings.of(v)) {
      if (on_lid[u]) continue;
      ++count;
      for (std::size_t s = 0; s < p.width; ++s) sum[s] += p.of(u)[s];
    }
    if (count == 0) continue;
    for (std::size_t s = 0; s < p.width; ++s) row[s] = (row[s] + sum[s] / count) / 2;
  }
  return result;
}

struct Peak {
  double offset_mm = 0, slope = 0;
};

/// Uphill from the middle to the nearest maximum, and to the vertex of the parabola there; none at an end of the row.
std::optional<Peak> peak_of(std::span<const double> row, double step_mm) {
  const Index middle = row.size() / 2;
  Index at = middle;
  while (at > 0 && at + 1 < std::ssize(row) && std::max(row[at - 1], row[at + 1]) > row[at])
    at = row[at + 1] > row[at - 1] ? at + 1 : at - 1;
  if (at == 0 || at + 1 == std::ssize(row)) return std::nullopt;
  const double bend = row[at - 1] - 2 * row[at] + row[at + 1];
  const double share = bend < 0 ? 0.5 * (row[at - 1] - row[at + 1]) / bend : 0;
  return Peak{step_mm * (at - middle + share), row[at]};
}

/// `least_slope`: what is no slope at all.
std::vector<std::optional<double>> offsets_of(const Profiles& profiles, const std::vector<bool>& on_lid,
                                              double least_slope) {
  std::vector<std::optional<Peak>> peaks(on_lid.size());
  std::vector<double> slopes;
  for (std::size_t v = 0; v < on_lid.size(); ++v) {
    if (!on_lid[v]) peaks[v] = peak_of(profiles.of(v), profiles.step_mm);
    if (peaks[v]) slopes.push_back(peaks[v]->slope);
  }
  std::vector<std::optional<double>> offsets(on_lid.size());
  const double least = std::max(least_slope, weak_slope * upper_median(std::move(slopes)));
  for (std::size_t v = 0; v < on_lid.size(); ++v)
    if (peaks[v] && peaks[v]->slope > least) offsets[v] = peaks[v]->offset_mm;
  return offsets;
}

double median_of(const std::vector<std::optional<double>>& offsets) {
  std::vector<double> known;
  for (const auto& offset : offsets)
    if (offset) known.push_back(*offset);
  return upper_median(std::move(known));
}

}  // namespace

TriMesh settle_on_slope(TriMesh mesh, const Image& image, const Vec3& base, const Settle& options) {
  const mesh::VertexRings rings = mesh::vertex_rings(mesh);
  float largest = 0;
  for (const float value : image.values) largest = std::max(largest, std::abs(value));
  std::vector<bool> on_lid;
  for (const Vec3& n : mesh::vertex_normals(mesh)) on_lid.push_back(n.dot(base) > lid_cosine);
  for (int round = 0; round < options.rounds; ++round) {
    const std::vector<Vec3> normals = mesh::vertex_normals(mesh);
    Profiles profiles = profiles_of(mesh, normals, image, options.reach_voxels);
    turn_upwards(profiles, on_lid);
    const std::vector<std::optional<double>> offsets =
        offsets_of(averaged(profiles, rings, on_lid), on_lid, no_slope * largest / profiles.step_mm);
    // Where a wall is not seen its neighbours are no guide: at the rim of a defect the slopes lead around its corner.
    const double usual = median_of(offsets);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (!on_lid[v]) mesh.vertices[v] += offsets[v].value_or(usual) * normals[v];
  }
  return mesh;
}

}  // namespace dynasurf::ventricle
