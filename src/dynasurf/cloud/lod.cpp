#include "dynasurf/cloud/lod.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::cloud {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();

/// Every edge that is not on a boundary stands in two triangles, so the mean over triangles is that over edges.
double mean_edge(const TriMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) sum += (mesh.vertices[t[i]] - mesh.vertices[t[(i + 1) % 3]]).norm();
  return sum / (3 * mesh.triangles.size());
}

double diagonal_of(const TriMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : mesh.vertices) box.extend(p);
  return box.diagonal().norm();
}

}  // namespace

double focal_px(const Camera& camera) {
  return camera.height_px / (2 * own::tan(camera.fov_deg * std::numbers::pi / 360));
}

double projected_size_px(const Vec3& low, const Vec3& high, const CameraPose& pose, const Camera& camera) {
  const Vec3 right = pose.forward.cross(pose.up);
  const double focal = focal_px(camera);
  Eigen::AlignedBox2d screen;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1) ? high[0] : low[0], (corner & 2) ? high[1] : low[1], (corner & 4) ? high[2] : low[2]);
    const Vec3 seen = p - pose.eye;
    const double depth = seen.dot(pose.forward);
    // A corner beside or behind the eye: the body reaches around the observer, and has no size on the screen.
    if (!(depth > 0)) return no_limit;
    screen.extend(Eigen::Vector2d(seen.dot(right), seen.dot(pose.up)) * (focal / depth));
  }
  return screen.sizes().maxCoeff();
}

LodChain lod_chain(std::span<const TriMesh> levels, const LodRule& rule) {
  LodChain chain;
  chain.rule = rule;
  check_options(chain.rule, "lod");
  if (levels.empty()) throw InputError("a chain of levels of detail without a level");
  for (const TriMesh& level : levels)
    if (level.triangles.empty()) throw InputError("a level of detail without a triangle");
  chain.diagonal = diagonal_of(levels[0]);
  chain.largest_px.push_back(no_limit);
  for (const TriMesh& level : levels.subspan(1))
    chain.largest_px.push_back(std::min(chain.largest_px.back(), rule.edge_px * chain.diagonal / mean_edge(level)));
  return chain;
}

std::size_t level_for_size(const LodChain& chain, double diagonal_px, std::optional<std::size_t> current) {
  const double give = current ? chain.rule.hysteresis_percent / 100 : 0;
  std::size_t level = 0;
  for (std::size_t i = 1; i < chain.largest_px.size(); ++i) {
    // Coarser levels than the current one must be due by more than the limit, finer ones too.
    const double limit = !current       ? chain.largest_px[i]
                         : i > *current ? chain.largest_px[i] * (1 - give)
                                        : chain.largest_px[i] * (1 + give);
    if (diagonal_px <= limit) level = i;
  }
  return level;
}

std::vector<double> switch_distances(const LodChain& chain, const Camera& camera) {
  Camera checked = camera;
  check_options(checked, "camera");
  std::vector<double> from;
  for (const double px : chain.largest_px) from.push_back(chain.diagonal * focal_px(camera) / px);
  return from;
}

std::size_t level_for_distance(std::span<const double> from, double distance, std::optional<std::size_t> current,
                               double hysteresis_percent) {
  const double give = current ? hysteresis_percent / 100 : 0;
  std::size_t level = 0;
  for (std::size_t i = 1; i < from.size(); ++i) {
    const double limit = !current ? from[i] : i > *current ? from[i] * (1 + give) : from[i] * (1 - give);
    if (distance >= limit) level = i;
  }
  return level;
}

LodBlend blend_for_size(const LodChain& chain, double diagonal_px) {
  const double band = chain.rule.hysteresis_percent / 100;
  double end = no_limit;  // of the band before; bands that would overlap are passed one after the other
  for (std::size_t next = 1; next < chain.largest_px.size(); ++next) {
    const double full = std::min(chain.largest_px[next], end);
    end = full * (1 - band);
    if (diagonal_px >= full) return {next - 1, 1};
    if (diagonal_px > end) return {next - 1, (diagonal_px - end) / (full - end)};
  }
  return {chain.largest_px.size() - 1, 1};
}

double share_of_plain_tessellation_percent(std::size_t triangles, std::size_t points) {
  if (points == 0) return 0;
  return 100.0 * triangles / (2.0 * points);
}

}  // namespace dynasurf::cloud
