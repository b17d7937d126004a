#include <algorithm>
#include <cmath>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/report/detail/page_parts.hpp"
#include "dynasurf/report/detail/page_template.hpp"
#include "dynasurf/report/report.hpp"

namespace dynasurf::report {
namespace {

using namespace detail;

constexpr std::size_t most_points = 50'000;

Box box_of(const cloud::Result& result) {
  Box box;
  const auto extend = [&](const std::vector<Vec3>& points) {
    for (const Vec3& p : points) {
      box.low = box.low.cwiseMin(p);
      box.high = box.high.cwiseMax(p);
    }
  };
  extend(result.used.points);
  for (const cloud::Level& level : result.levels) extend(level.mesh.vertices);
  return box;
}

/// Three bytes each; null when there are none.
Json colours_json(const std::vector<std::array<std::uint8_t, 3>>& colours) {
  if (colours.empty()) return nullptr;
  Bytes bytes;
  bytes.reserve(3 * colours.size());
  for (const auto& colour : colours) bytes.insert(bytes.end(), colour.begin(), colour.end());
  return packed(bytes);
}

/// Points for the eye: evenly many of each stretch of the cloud's order.
Json points_json(const PointCloud& cloud, const Box& box) {
  const std::size_t count = cloud.points.size(), shown = std::min(count, most_points);
  std::vector<Vec3> points;
  std::vector<std::array<std::uint8_t, 3>> colours;
  for (std::size_t n = 0; n < shown; ++n) {
    const std::size_t at = n * count / shown;
    points.push_back(cloud.points[at]);
    if (!cloud.colours.empty()) colours.push_back(cloud.colours[at]);
  }
  return {{"shown", shown}, {"positions", packed(steps_of(points, box))}, {"colours", colours_json(colours)}};
}

/// 16-bit steps of `full`; 65535 where nothing can be said.
std::string errors_of(const std::vector<float>& errors, double full) {
  Bytes bytes;
  for (const float error : errors) {
    const double share = full > 0 ? error / full : 0;
    append<std::uint16_t>(bytes, error < 0 ? 65535 : std::clamp(std::round(share * 65534), 0.0, 65534.0));
  }
  return packed(bytes);
}

/// 16-bit steps of 1; null where nothing is known.
Json confidence_json(const std::vector<float>& confidence) {
  if (confidence.empty()) return nullptr;
  Bytes bytes;
  // What is made up stays below 1.
  for (const float c : confidence)
    append<std::uint16_t>(bytes, c >= 1 ? 65535 : std::clamp(std::round(c * 65535), 0.0F, 65534.0F));
  return packed(bytes);
}

Json levels_json(const cloud::Result& result, const Box& box, double& full_error) {
  full_error = 0;
  for (const cloud::Level& level : result.levels)
    for (const float error : level.errors) full_error = std::max<double>(full_error, error);
  Json json = Json::array();
  for (const cloud::Level& level : result.levels)
    json.push_back({{"positions", packed(steps_of(level.mesh.vertices, box))},
                    {"triangles", triangles_of(level.mesh)},
                    {"errors", errors_of(level.errors, full_error)},
                    {"confidence", confidence_json(level.confidence)},
                    {"colours", colours_json(level.colours)}});
  return json;
}

/// How level n grows out of level n + 1.
Json growth_json(const cloud::Result& result, const Box& box, std::size_t n) {
  const TriMesh &fine = result.levels[n].mesh, &coarse = result.levels[n + 1].mesh;
  if (fine.triangles.empty() || coarse.triangles.empty()) return nullptr;
  return transition_json(cloud::lod_transition(coarse, fine), box);
}

}  // namespace

std::string cloud_report_html(const CloudRun& run, const Provenance& provenance, Timings timings) {
  const cloud::Result& result = run.result;
  const Box box = box_of(result);
  double full_error = 0;
  Json points, levels;
  std::vector<Json> growths(result.levels.empty() ? 0 : result.levels.size() - 1);
  parallel_for(growths.size() + 2, 1, [&](std::size_t task, std::size_t) {
    if (task < growths.size())
      growths[task] = growth_json(result, box, task);
    else if (task == growths.size())
      levels = levels_json(result, box, full_error);
    else
      points = points_json(result.used, box);
  });
  Json data = Json::object();
  data["results"] = cloud_results_json(run, provenance, timings);
  data["low"] = {box.low[0], box.low[1], box.low[2]};
  data["high"] = {box.high[0], box.high[1], box.high[2]};
  data["cloud"] = std::move(points);
  data["levels"] = std::move(levels);
  data["full_error"] = full_error;
  data["transitions"] = std::move(growths);
  return filled_page(cloud_page_template(), data);
}

void write_cloud_report(const CloudRun& run, const Provenance& provenance, const std::filesystem::path& path,
                        Timings timings) {
  io::write_file(path, cloud_report_html(run, provenance, timings));
}

}  // namespace dynasurf::report
