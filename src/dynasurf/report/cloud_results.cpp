#include <algorithm>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/report/detail/json_parts.hpp"
#include "dynasurf/report/report.hpp"

namespace dynasurf::report {
namespace {

using namespace detail;

Json angles_json(const cloud::Certificate& c) {
  return {{"smallest", number(c.smallest_angle_deg)},
          {"percentile_1", number(c.angle_percentile_1_deg)},
          {"percentile_5", number(c.angle_percentile_5_deg)},
          {"mean", number(c.angle_mean_deg)}};
}

/// Distances in the cloud's unit and in percent of its diagonal.
Json distances_json(const cloud::Certificate& c) {
  const auto share = [&](double length) {
    return c.cloud_diagonal > 0 ? number(100 * length / c.cloud_diagonal) : Json(nullptr);
  };
  const auto pair = [&](double mean, double largest) -> Json {
    return {{"mean", number(mean)},
            {"largest", number(largest)},
            {"mean_percent", share(mean)},
            {"largest_percent", share(largest)}};
  };
  return {{"cloud_to_mesh", pair(c.cloud_to_mesh_mean, c.cloud_to_mesh_largest)},
          {"mesh_to_cloud", pair(c.mesh_to_cloud_mean, c.mesh_to_cloud_largest)}};
}

Json certificate_json(const cloud::Certificate& c) {
  Json json = Json::object();
  json["watertight"] = c.watertight();
  json["closed"] = c.closed;
  json["manifold"] = c.manifold;
  json["oriented"] = c.oriented;
  json["outward"] = c.outward;
  json["self_intersections"] = c.self_intersections;
  json["flat_triangles"] = c.flat_triangles;
  json["components"] = c.components;
  json["boundary_loops"] = c.boundary_loops;
  json["genus"] = c.genus ? Json(*c.genus) : Json(nullptr);
  json["angles_deg"] = angles_json(c);
  json["distances"] = distances_json(c);
  // An open surface encloses nothing.
  json["volume"] = c.boundary_loops > 0 ? Json(nullptr) : number(c.volume);
  json["area"] = number(c.area);
  return json;
}

/// Largest size on the screen of each level; nothing where a level has no triangle to measure.
std::vector<double> largest_sizes(const cloud::Result& result) {
  std::vector<TriMesh> meshes;
  for (const cloud::Level& level : result.levels) {
    if (level.mesh.triangles.empty()) return {};
    meshes.push_back(level.mesh);
  }
  return meshes.empty() ? std::vector<double>{} : cloud::lod_chain(meshes).largest_px;
}

Json levels_json(const cloud::Result& result) {
  const std::vector<double> sizes = largest_sizes(result);
  Json levels = Json::array();
  for (std::size_t n = 0; n < result.levels.size(); ++n) {
    const cloud::Level& level = result.levels[n];
    Json json = Json::object();
    json["level"] = n + 1;
    json["name"] = name_of_level(result, n);
    json["triangles_asked"] = level.triangles_asked;
    json["triangles"] = level.mesh.triangles.size();
    json["vertices"] = level.mesh.vertices.size();
    json["share_of_plain_tessellation_percent"] =
        number(cloud::share_of_plain_tessellation_percent(level.mesh.triangles.size(), result.facts.points_used));
    json["largest_screen_px"] = n < sizes.size() ? number(sizes[n]) : Json(nullptr);
    json["certificate"] = certificate_json(level.certificate);
    levels.push_back(std::move(json));
  }
  return levels;
}

Json cloud_json(const CloudRun& run) {
  const cloud::Facts& f = run.result.facts;
  const PointCloud& used = run.result.used;
  Json sources = Json::array();
  for (const io::CloudSource& source : run.sources)
    sources.push_back({{"format", source.format}, {"points", source.points}, {"triangles", source.triangles}});
  std::uint32_t scans = 0;
  for (const std::uint32_t scan : used.scans) scans = std::max(scans, scan);
  Json json = Json::object();
  json["files"] = std::move(sources);
  json["points"] = f.points;
  json["not_finite"] = f.not_finite;
  json["duplicates"] = f.duplicates;
  json["outliers"] = f.outliers;
  json["points_used"] = f.points_used;
  json["has_normals"] = !used.normals.empty();
  json["has_colours"] = !used.colours.empty();
  json["scans"] = scans + 1;  // numbered from 0; points without numbers are one scan
  json["diagonal"] = number(f.diagonal);
  json["spacing"] = number(f.spacing);
  json["noise"] = number(f.noise);
  json["cells"] = f.cells;
  json["parts"] = f.parts;
  json["genus"] = f.genus;
  json["boundary_loops"] = f.boundary_loops;
  return json;
}

/// Shares in percent.
Json support_json(const cloud::CloudSupport& s) {
  Json json = Json::object();
  json["within"] = number(s.within);
  json["points_off_percent"] = number(100 * s.points_off);
  json["points_off_mean_ratio"] = number(s.points_off_mean);
  json["points_left_out_percent"] = number(100 * s.points_left_out);
  json["biased_percent"] = number(100 * s.biased);
  json["made_up_percent"] = number(100 * s.made_up);
  json["made_up_largest_percent"] = number(100 * s.made_up_largest);
  json["unfaced_points"] = number(s.unfaced_points);
  json["turned_percent"] = number(100 * s.turned);
  json["thin_percent"] = number(100 * s.thin);
  json["gaps_percent"] = number(100 * s.gaps);
  json["firm_percent"] = number(100 * s.firm);
  return json;
}

Json notes_json(const Notes& notes) {
  Json json = Json::array();
  for (const Note& note : notes)
    json.push_back({{"severity", name_of(note.severity)}, {"code", note.code}, {"message", note.message}});
  return json;
}

Json timings_json(const CloudRun& run, Timings timings) {
  if (timings == Timings::omit) return nullptr;
  Json json = Json::object();
  for (const auto& [stage, seconds] : run.seconds) json[stage] = number(seconds);
  return json;
}

Json memory_json(const CloudRun& run, Timings timings) {
  const std::size_t points = run.result.facts.points;
  if (timings == Timings::omit || run.peak_bytes == 0 || points == 0) return nullptr;
  return {{"peak_bytes", run.peak_bytes}, {"bytes_per_point", number(1.0 * run.peak_bytes / points)}};
}

}  // namespace

bool is_trustworthy(const cloud::Result& result) { return cloud::verdict_of(result) != cloud::Verdict::fail; }

std::string name_of_level(const cloud::Result& result, std::size_t level) {
  const bool is_closed = result.facts.boundary == cloud::BoundaryRule::close;
  return "level" + std::to_string(level + 1) +
         (is_sound(result, result.levels[level]) ? ""
          : is_closed                            ? "_not_watertight"
                                                 : "_not_sound");
}

nlohmann::ordered_json cloud_results_json(const CloudRun& run, const Provenance& provenance, Timings timings) {
  Json json = Json::object();
  json["schema"] = "dynasurf.cloud/1";
  json["verdict"] = word_of(cloud::verdict_of(run.result));
  json["boundary"] = word_of(run.result.facts.boundary);
  json["watertight"] = cloud::is_watertight(run.result);
  json["levels"] = levels_json(run.result);
  json["cloud"] = cloud_json(run);
  json["support"] = support_json(run.result.support);
  json["notes"] = notes_json(run.result.notes);
  json["provenance"] = provenance_json(provenance);
  json["timings_s"] = timings_json(run, timings);
  json["memory"] = memory_json(run, timings);
  return json;
}

std::string cloud_results_csv(const cloud::Result& result) {
  TextOutput csv;
  csv.precision(9);
  csv << "level,triangles_asked,triangles,vertices,watertight,boundary_loops,components,genus,self_intersections,"
         "smallest_angle_deg,"
         "cloud_to_mesh_mean,cloud_to_mesh_largest,mesh_to_cloud_mean,mesh_to_cloud_largest,volume,area\n";
  for (std::size_t n = 0; n < result.levels.size(); ++n) {
    const cloud::Level& level = result.levels[n];
    const cloud::Certificate& c = level.certificate;
    csv << n + 1 << ',' << level.triangles_asked << ',' << c.triangles << ',' << c.vertices << ',' << c.watertight()
        << ',' << c.boundary_loops << ',' << c.components << ',';
    if (c.genus) csv << *c.genus;
    csv << ',' << c.self_intersections << ',' << c.smallest_angle_deg << ',' << c.cloud_to_mesh_mean << ','
        << c.cloud_to_mesh_largest << ',' << c.mesh_to_cloud_mean << ',' << c.mesh_to_cloud_largest << ',';
    if (c.boundary_loops == 0) csv << c.volume;
    csv << ',' << c.area << '\n';
  }
  return csv.str();
}

}  // namespace dynasurf::report
