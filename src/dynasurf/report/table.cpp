#include "dynasurf/report/numbers.hpp"
#include "dynasurf/report/report.hpp"

namespace dynasurf {
namespace {

using report_detail::text_of;

struct Column {
  const char* name;
  std::string (*text)(const Surface&);
};

constexpr Column surface_columns[] = {
    {"stop_reason", [](const Surface& s) { return std::string(name_of(s.stop_reason)); }},
    {"steps", [](const Surface& s) { return std::to_string(s.steps); }},
    {"stopped_fraction", [](const Surface& s) { return text_of(s.stopped_fraction); }},
    {"within_one_voxel", [](const Surface& s) { return text_of(s.within_one_voxel); }},
    {"border_reached", [](const Surface& s) { return text_of(s.border_reached); }},
    {"mean_distance_mm", [](const Surface& s) { return text_of(s.mean_distance_mm); }},
    {"area_mean_mm2", [](const Surface& s) { return text_of(s.quality.area_mean); }},
    {"area_min_mm2", [](const Surface& s) { return text_of(s.quality.area_min); }},
    {"area_max_mm2", [](const Surface& s) { return text_of(s.quality.area_max); }},
    {"shape_mean", [](const Surface& s) { return text_of(s.quality.shape_mean); }},
    {"shape_min", [](const Surface& s) { return text_of(s.quality.shape_min); }},
    {"smallest_angle_deg", [](const Surface& s) { return text_of(s.quality.smallest_angle_deg); }},
};

std::optional<double> volume_of(const std::optional<Surface>& surface) {
  return surface ? std::optional(surface->volume_ml) : std::nullopt;
}

}  // namespace

std::string results_csv(const VentricleResult& result) {
  std::string csv = "gate,time_ms,endo_ml,epi_ml,wall_ml";
  for (const char* wall : {"endo", "epi"})
    for (const Column& column : surface_columns) csv += std::string(",") + wall + "_" + column.name;
  csv += '\n';
  for (const Gate& gate : result.gates) {
    csv += std::to_string(gate.gate + 1) + ',' + text_of(gate.time_ms) + ',' + text_of(volume_of(gate.endo)) + ',' +
           text_of(volume_of(gate.epi)) + ',' + text_of(gate.wall_ml);
    for (const auto* surface : {&gate.endo, &gate.epi})
      for (const Column& column : surface_columns) csv += ',' + (*surface ? column.text(**surface) : std::string());
    csv += '\n';
  }
  return csv;
}

}  // namespace dynasurf
