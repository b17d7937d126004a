#include "dynasurf/report/detail/numbers.hpp"
#include "dynasurf/report/report.hpp"

namespace dynasurf::report {
namespace {

using detail::text_of;

struct SurfaceColumn {
  const char* name;
  std::string (*text)(const ventricle::Surface&);
};

constexpr SurfaceColumn surface_columns[] = {
    {"stop_reason", [](const ventricle::Surface& s) { return std::string(dynamics::name_of(s.stop_reason)); }},
    {"steps", [](const ventricle::Surface& s) { return std::to_string(s.steps); }},
    {"stopped_fraction", [](const ventricle::Surface& s) { return text_of(s.stopped_fraction); }},
    {"within_one_voxel", [](const ventricle::Surface& s) { return text_of(s.within_one_voxel); }},
    {"border_reached", [](const ventricle::Surface& s) { return text_of(s.border_reached); }},
    {"mean_distance_mm", [](const ventricle::Surface& s) { return text_of(s.mean_distance_mm); }},
    {"area_mean_mm2", [](const ventricle::Surface& s) { return text_of(s.quality.area_mean); }},
    {"area_min_mm2", [](const ventricle::Surface& s) { return text_of(s.quality.area_min); }},
    {"area_max_mm2", [](const ventricle::Surface& s) { return text_of(s.quality.area_max); }},
    {"shape_mean", [](const ventricle::Surface& s) { return text_of(s.quality.shape_mean); }},
    {"shape_min", [](const ventricle::Surface& s) { return text_of(s.quality.shape_min); }},
    {"smallest_angle_deg", [](const ventricle::Surface& s) { return text_of(s.quality.smallest_angle_deg); }},
};

std::string volume_cells(const std::optional<ventricle::LeadingSurface>& surface) {
  if (!surface) return ",,";
  const heart::Estimate& ml = surface->volume_ml;
  const auto end = [&](double value) { return ml.has_interval() ? text_of(value) : std::string(); };
  return text_of(ml.value) + ',' + end(ml.low()) + ',' + end(ml.high());
}

std::string volume_cell(const std::optional<ventricle::Surface>& surface) {
  return surface ? text_of(surface->volume_ml) : std::string();
}

}  // namespace

std::string results_csv(const ventricle::Result& result) {
  std::string csv = "gate,time_ms";
  for (const char* wall : {"endo_ml", "epi_ml"})
    for (const char* part : {"", "_low", "_high"}) csv += std::string(",") + wall + part;
  csv += ",edge_endo_ml,edge_epi_ml,edge_wall_ml";
  for (const char* wall : {"endo", "epi"})
    for (const SurfaceColumn& column : surface_columns) csv += std::string(",edge_") + wall + "_" + column.name;
  csv += '\n';
  for (const ventricle::Gate& gate : result.gates) {
    const ventricle::EdgeSurfaces& edge = gate.edge_surfaces;
    csv += std::to_string(gate.gate + 1) + ',' + text_of(gate.time_ms) + ',' + volume_cells(gate.surfaces.endo) + ',' +
           volume_cells(gate.surfaces.epi) + ',' + volume_cell(edge.endo) + ',' + volume_cell(edge.epi) + ',' +
           text_of(edge.wall_ml);
    for (const auto* surface : {&edge.endo, &edge.epi})
      for (const SurfaceColumn& column : surface_columns)
        csv += ',' + (*surface ? column.text(**surface) : std::string());
    csv += '\n';
  }
  return csv;
}

}  // namespace dynasurf::report
