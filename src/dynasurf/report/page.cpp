#include <algorithm>
#include <cmath>
#include <cstring>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/report/detail/page_motion.hpp"
#include "dynasurf/report/detail/page_parts.hpp"
#include "dynasurf/report/detail/page_pictures.hpp"
#include "dynasurf/report/detail/page_template.hpp"
#include "dynasurf/report/measures.hpp"
#include "dynasurf/report/report.hpp"

namespace dynasurf::report {
namespace {

using namespace detail;

/// What the fit compared: the model as bytes from `low` to `high`, the data less the model as bytes from -`most` to
/// `most` (128: none), in parts of healthy muscle, and the weights of the pixels.
Json fit_json(const ventricle::Result& result, std::size_t most_voxels) {
  if (!result.readings.psf_corrected || result.readings.psf_corrected->images.data.empty()) return nullptr;
  const psf_fit::FitImages& images = result.readings.psf_corrected->images;
  if (images.data.size() * images.weight.values.size() > most_voxels) return nullptr;
  float low = 0, high = 0;
  double squares = 0, count = 0;
  for (std::size_t g = 0; g < images.data.size(); ++g)
    for (std::size_t n = 0; n < images.weight.values.size(); ++n) {
      const float model = images.model[g].values[n];
      low = std::min(low, model);
      high = std::max(high, model);
      if (images.weight.values[n] <= 0) continue;
      const double left = images.data[g].values[n] - model;
      squares += left * left;
      count += 1;
    }
  // Differences of five times the usual one stand out; larger ones look the same.
  const double most = std::max(1e-6, 5 * std::sqrt(squares / std::max(1.0, count)));
  Bytes models, differences, weights;
  for (std::size_t g = 0; g < images.data.size(); ++g)
    for (std::size_t n = 0; n < images.weight.values.size(); ++n) {
      const double model = images.model[g].values[n];
      models.push_back(byte_of(255 * (model - low) / std::max<double>(1e-6, high - low)));
      differences.push_back(byte_of(128 + 127 * (images.data[g].values[n] - model) / most));
    }
  for (const float w : images.weight.values) weights.push_back(byte_of(255 * double{w}));
  Json json = Json::object();
  json["grid"] = grid_json(images.weight.grid);
  json["low"] = low;
  json["high"] = high;
  json["most"] = most;
  json["rms"] = std::sqrt(squares / std::max(1.0, count));
  json["model"] = packed(models);
  json["difference"] = packed(differences);
  json["weight"] = packed(weights);
  return json;
}

Box box_of(const std::vector<ventricle::Gate>& gates) {
  Box box;
  for (const ventricle::Gate& gate : gates)
    for (const auto* surface : {&gate.surfaces.endo, &gate.surfaces.epi})
      if (*surface)
        for (const Vec3& p : (*surface)->mesh.vertices) {
          box.low = box.low.cwiseMin(p);
          box.high = box.high.cwiseMax(p);
        }
  return box;
}

/// One entry per gate: its vertices, and the number of its triangles in the list that all surfaces share.
Json surfaces_json(const ventricle::Result& result) {
  const Box box = box_of(result.gates);
  // Surfaces that came from one start share their triangles, which the page holds once.
  std::vector<const TriMesh*> topologies;
  const auto topology_of = [&](const TriMesh& mesh) {
    const auto at = std::find_if(topologies.begin(), topologies.end(),
                                 [&](const TriMesh* known) { return known->triangles == mesh.triangles; });
    const auto number = at - topologies.begin();
    if (at == topologies.end()) topologies.push_back(&mesh);
    return number;
  };
  const auto surface_json = [&](const std::optional<ventricle::LeadingSurface>& surface) -> Json {
    if (!surface || surface->mesh.vertices.empty()) return nullptr;
    return {{"triangles", topology_of(surface->mesh)}, {"positions", base64(steps_of(surface->mesh.vertices, box))}};
  };
  Json json = Json::object();
  json["endo"] = json["epi"] = json["samples"] = Json::array();
  for (const ventricle::Gate& gate : result.gates) {
    json["endo"].push_back(surface_json(gate.surfaces.endo));
    json["epi"].push_back(surface_json(gate.surfaces.epi));
  }
  if (topologies.empty()) return nullptr;
  json["low_mm"] = {box.low[0], box.low[1], box.low[2]};
  json["high_mm"] = {box.high[0], box.high[1], box.high[2]};
  json["triangles"] = Json::array();
  for (const TriMesh* mesh : topologies) json["triangles"].push_back(triangles_of(*mesh));
  return json;
}

/// The sample of the polar maps at every vertex, two bytes each, the low one first; 65535: on the lid.
std::string samples_of_vertices(const ventricle::PolarGrid& grid, const ventricle::HeartAxes& axes,
                                const std::vector<Vec3>& vertices) {
  Bytes bytes;
  for (const Vec3& p : vertices) {
    const ventricle::PolarPoint at = axes.polar(p);
    const int ring = std::min<int>(grid.rings - 1, at.rho * grid.rings);
    const int sector = std::min<int>(grid.sectors - 1, at.angle_deg * grid.sectors / 360);
    const std::size_t sample = axes.above_base(p) > -0.1 ? 65535 : grid.index(ring, sector);
    append<std::uint16_t>(bytes, sample);
  }
  return base64(bytes);
}

/// The polar maps, and the segment of every vertex as one byte, gate by gate; of the endocardium also the samples.
Json polar_json(const ventricle::Result& result) {
  if (!result.measures || result.measures->segments.empty()) return nullptr;
  const ventricle::Measures& m = *result.measures;
  Json json = Json::object();
  json["rings"] = m.grid.rings;
  json["sectors"] = m.grid.sectors;
  json["maps"] = Json::array();
  for (const PolarKind& kind : polar_kinds()) {
    const ventricle::PolarValues& values = m.maps.*kind.values;
    if (values.empty()) continue;
    Json samples = Json::array();
    for (const auto& v : values) samples.push_back(v ? Json(std::round(*v * 10) / 10) : Json(nullptr));
    json["maps"].push_back({{"name", kind.name},
                            {"title", kind.title},
                            {"unit", kind.unit},
                            {"low", kind.low ? Json(*kind.low) : Json(nullptr)},
                            {"high", kind.high ? Json(*kind.high) : Json(nullptr)},
                            {"cyclic", kind.is_cyclic},
                            {"values", std::move(samples)}});
  }
  json["places"] = Json::array();
  for (const ventricle::Segment& s : ventricle::segments_of(m.model))
    json["places"].push_back(
        {{"rho_low", s.rho_low}, {"rho_high", s.rho_high}, {"middle_deg", s.middle_deg}, {"width_deg", s.width_deg}});
  json["endo"] = json["epi"] = Json::array();
  for (std::size_t g = 0; g < m.gates.size(); ++g) {
    for (const ventricle::Border wall : {ventricle::Border::endo, ventricle::Border::epi}) {
      const std::string name(ventricle::name_of(wall));
      const auto& surface = result.gates[g].surfaces.of(wall);
      if (!m.gates[g].axes || !surface) {
        json[name].push_back(nullptr);
        if (wall == ventricle::Border::endo) json["samples"].push_back(nullptr);
        continue;
      }
      const std::vector<Vec3>& vertices = surface->mesh.vertices;
      if (wall == ventricle::Border::endo)
        json["samples"].push_back(samples_of_vertices(m.grid, *m.gates[g].axes, vertices));
      const std::vector<int> segments = ventricle::segments_of_vertices(m.model, *m.gates[g].axes, vertices);
      json[name].push_back(base64(Bytes(segments.begin(), segments.end())));
    }
  }
  return json;
}

}  // namespace

std::string report_html(const ventricle::Result& result, const Provenance& provenance, Timings timings,
                        std::size_t most_voxels) {
  Json data = Json::object();
  data["results"] = results_json(result, provenance, timings);
  data["pictures"] = pictures_json(result, most_voxels);
  data["fit"] = fit_json(result, most_voxels);
  data["surfaces"] = surfaces_json(result);
  data["motion"] = evolution_json(result);
  data["contours"] = contours_json(result);
  data["polar"] = polar_json(result);

  return filled_page(page_template(), data);
}

void write_report(const ventricle::Result& result, const Provenance& provenance, const std::filesystem::path& path,
                  Timings timings) {
  io::write_file(path, report_html(result, provenance, timings));
}

}  // namespace dynasurf::report
