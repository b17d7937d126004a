#include "dynasurf/report/measures.hpp"

#include "dynasurf/psf_fit/blur_fit.hpp"
#include "dynasurf/report/detail/numbers.hpp"

namespace dynasurf::report {
namespace {

using detail::Json;
using detail::number;
using detail::text_of;
using detail::vector_json;

Json function_json(const std::optional<ventricle::VolumeCurveFit>& f, double cycle_ms) {
  if (!f) return nullptr;
  // The fit knows phases of the beat alone; times need the length of the beat, which a study may not tell.
  const auto in_ms = [&](double beats) { return cycle_ms > 0 ? number(beats * cycle_ms) : Json(nullptr); };
  Json json = Json::object();
  json["waves"] = f->waves;
  json["edv_ml"] = number(f->edv_ml);
  json["esv_ml"] = number(f->esv_ml);
  json["sv_ml"] = number(f->sv_ml);
  json["ef_percent"] = number(f->ef_percent);
  json["residual_ml"] = number(f->residual_ml);
  json["ed_time"] = number(f->ed_time);
  json["es_time"] = number(f->es_time);
  json["end_rapid_filling_time"] = number(f->end_rapid_filling);
  json["peak_emptying_edv_per_beat"] = number(f->peak_emptying);
  json["peak_filling_edv_per_beat"] = number(f->peak_filling);
  json["peak_emptying_edv_per_s"] = number(ventricle::per_second(f->peak_emptying, cycle_ms));
  json["peak_filling_edv_per_s"] = number(ventricle::per_second(f->peak_filling, cycle_ms));
  json["time_to_peak_filling"] = number(f->time_to_peak_filling);
  json["time_to_peak_filling_ms"] = in_ms(f->time_to_peak_filling);
  json["first_third_filling"] = number(f->first_third_filling);
  json["first_third_rate_edv_per_s"] = number(ventricle::per_second(f->first_third_rate, cycle_ms));
  json["instants"] = {{"edv_ml", number(f->instant_edv_ml)},
                      {"esv_ml", number(f->instant_esv_ml)},
                      {"ef_percent", number(f->instant_ef_percent)}};
  json["mean_ml"] = number(f->curve.mean);
  json["cosine_ml"] = f->curve.cosine;
  json["sine_ml"] = f->curve.sine;
  return json;
}

Json thickness_json(const ventricle::Measures& m) {
  Json gates = Json::array();
  for (std::size_t g = 0; g < m.gates.size(); ++g) {
    const auto& s = m.gates[g].thickness.summary;
    if (!s) {
      gates.push_back(nullptr);
      continue;
    }
    gates.push_back({{"gate", g + 1},
                     {"mean_mm", number(s->mean_mm)},
                     {"sd_mm", number(s->sd_mm)},
                     {"min_mm", number(s->min_mm)},
                     {"max_mm", number(s->max_mm)},
                     {"from_endo_mm", number(s->from_endo_mm)},
                     {"from_epi_mm", number(s->from_epi_mm)},
                     {"nearest", s->nearest},
                     {"crossing", s->crossing}});
  }
  return gates;
}

/// 90 % interval of a number with a standard deviation; null where one is missing.
Json interval_json(const std::optional<double>& value, const std::optional<double>& sd) {
  if (!value || !sd) return nullptr;
  const heart::Estimate e{*value, *sd};
  return {number(e.low()), number(e.high())};
}

Json phase_json(const std::optional<ventricle::PhaseSummary>& s) {
  if (!s) return nullptr;
  return {{"mean_deg", number(s->mean_deg)},
          {"sd_deg", number(s->sd_deg)},
          {"sd_deg_90", interval_json(s->sd_deg, s->sd_error_deg)},
          {"bandwidth_deg", number(s->bandwidth_deg)},
          {"entropy_percent", number(s->entropy_percent)},
          {"wall_share", number(s->wall_share)},
          {"bin_deg", s->bin_deg},
          {"histogram_percent", s->histogram_percent}};
}

struct Column {
  std::string_view name;
  std::optional<double> ventricle::SegmentMeasures::*value;
  std::optional<double> ventricle::SegmentErrors::*sd = nullptr;  // null: never known
};
/// JSON, CSV and their heads are made of this one list, so that none can lack what another has.
constexpr std::array<Column, 11> columns{{
    {"perfusion_percent", &ventricle::SegmentMeasures::perfusion_percent, &ventricle::SegmentErrors::perfusion_percent},
    {"thickness_ed_mm", &ventricle::SegmentMeasures::thickness_ed_mm, &ventricle::SegmentErrors::thickness_ed_mm},
    {"thickness_es_mm", &ventricle::SegmentMeasures::thickness_es_mm, &ventricle::SegmentErrors::thickness_es_mm},
    {"thickening_percent", &ventricle::SegmentMeasures::thickening_percent,
     &ventricle::SegmentErrors::thickening_percent},
    {"count_thickening_percent", &ventricle::SegmentMeasures::count_thickening_percent},
    {"motion_mm", &ventricle::SegmentMeasures::motion_mm, &ventricle::SegmentErrors::motion_mm},
    {"displacement_mm", &ventricle::SegmentMeasures::displacement_mm, &ventricle::SegmentErrors::displacement_mm},
    {"area_strain_percent", &ventricle::SegmentMeasures::area_strain_percent,
     &ventricle::SegmentErrors::area_strain_percent},
    {"phase_counts_deg", &ventricle::SegmentMeasures::phase_counts_deg},
    {"phase_motion_deg", &ventricle::SegmentMeasures::phase_motion_deg, &ventricle::SegmentErrors::phase_motion_deg},
    {"phase_thickness_deg", &ventricle::SegmentMeasures::phase_thickness_deg,
     &ventricle::SegmentErrors::phase_thickness_deg},
}};

Json segment_json(const ventricle::SegmentMeasures& s) {
  Json json = Json::object();
  json["number"] = s.segment.number;
  json["name"] = s.segment.name;
  json["territory"] = s.segment.territory;
  json["wall_share_percent"] = number(s.wall_share_percent);
  for (const Column& column : columns) {
    json[std::string(column.name)] = number(s.*column.value);
    if (column.sd) json[std::string(column.name) + "_90"] = interval_json(s.*column.value, s.sd.*column.sd);
  }
  return json;
}

/// Fixed ends give a colour the same meaning in all studies; maps without them run from the least to the largest value.
constexpr std::array<PolarKind, 9> kinds{{
    {"perfusion_percent", "Perfusion", "%", &ventricle::PolarMaps::perfusion_percent, 0, 100},
    {"thickness_ed_mm", "Thickness, end diastole", "mm", &ventricle::PolarMaps::thickness_ed_mm, std::nullopt,
     std::nullopt},
    {"thickness_es_mm", "Thickness, end systole", "mm", &ventricle::PolarMaps::thickness_es_mm, std::nullopt,
     std::nullopt},
    {"thickening_percent", "Thickening", "%", &ventricle::PolarMaps::thickening_percent, 0, 80},
    {"count_thickening_percent", "Thickening by counts", "%", &ventricle::PolarMaps::count_thickening_percent, 0, 80},
    {"motion_mm", "Inward motion", "mm", &ventricle::PolarMaps::motion_mm, 0, 12},
    {"phase_counts_deg", "Onset by counts", "deg", &ventricle::PolarMaps::phase_counts_deg, 0, 360, true},
    {"phase_motion_deg", "Onset by motion", "deg", &ventricle::PolarMaps::phase_motion_deg, 0, 360, true},
    {"phase_thickness_deg", "Onset by thickness", "deg", &ventricle::PolarMaps::phase_thickness_deg, 0, 360, true},
}};

}  // namespace

std::span<const PolarKind> polar_kinds() { return kinds; }

Json measures_json(const std::optional<ventricle::Measures>& measures, double cycle_ms) {
  if (!measures) return nullptr;
  const ventricle::Measures& m = *measures;
  Json segments = Json::array();
  for (const ventricle::SegmentMeasures& s : m.segments) segments.push_back(segment_json(s));
  Json json = Json::object();
  json["thickness_is"] = m.cavity_alone ? Json(nullptr) : Json(m.from_edges ? "apparent" : "model");
  json["perfusion_is"] = m.perfusion_is == ventricle::Perfusion::none ? Json(nullptr) : Json(word_of(m.perfusion_is));
  json["anterior"] = {{"rule", word_of(m.anterior.rule)}, {"direction", vector_json(m.anterior.direction)}};
  json["muscle_ml"] = number(m.muscle_ml);
  json["muscle_g"] = number(m.muscle_g);
  json["function"] = function_json(m.function, cycle_ms);
  json["thickness"] = thickness_json(m);
  json["phase"] = {{"counts", phase_json(m.phase_counts)},
                   {"motion", phase_json(m.phase_motion)},
                   {"thickness", phase_json(m.phase_thickness)}};
  json["segment_model"] = word_of(m.model);
  json["segments"] = std::move(segments);
  return json;
}

std::string segments_csv(const ventricle::Measures& m) {
  std::string csv = "number,name,territory,wall_share_percent";
  for (const Column& column : columns) csv += "," + std::string(column.name);
  for (const Column& column : columns)
    if (column.sd) csv += "," + std::string(column.name) + "_sd";
  csv += '\n';
  for (const ventricle::SegmentMeasures& s : m.segments) {
    csv += std::to_string(s.segment.number) + "," + std::string(s.segment.name) + "," +
           std::string(s.segment.territory) + "," + text_of(std::optional(s.wall_share_percent));
    for (const Column& column : columns) csv += "," + text_of(s.*column.value);
    for (const Column& column : columns)
      if (column.sd) csv += "," + text_of(s.sd.*column.sd);
    csv += '\n';
  }
  return csv;
}

std::string polar_csv(const ventricle::Measures& m) {
  std::string csv = "ring,sector,rho,angle_deg,segment,area_mm2";
  for (const PolarKind& kind : kinds) csv += "," + std::string(kind.name);
  csv += '\n';
  for (std::size_t n = 0; n < m.grid.size(); ++n) {
    const ventricle::PolarPoint at = m.grid.point(n);
    const std::size_t sectors = m.grid.sectors;
    csv += std::to_string(n / sectors + 1) + "," + std::to_string(n % sectors + 1) + "," + text_of(at.rho, 5) + "," +
           text_of(at.angle_deg, 3) + "," + std::to_string(ventricle::segment_at(m.model, at)) + "," +
           (n < m.area_mm2.size() ? text_of(m.area_mm2[n], 3) : "");
    for (const PolarKind& kind : kinds) {
      const ventricle::PolarValues& values = m.maps.*kind.values;
      csv += "," + (n < values.size() && values[n] ? text_of(*values[n], 3) : std::string());
    }
    csv += '\n';
  }
  return csv;
}

std::string curve_csv(const ventricle::VolumeCurveFit& function) {
  constexpr int instants = 64;
  std::string csv = "phase,volume_ml,rate_edv_per_beat\n";
  for (int n = 0; n < instants; ++n) {
    const double phase = 1.0 * n / instants;
    csv += text_of(phase, 6) + "," + text_of(function.curve.at(phase), 4) + "," +
           text_of(function.curve.slope(phase) / function.edv_ml, 5) + "\n";
  }
  return csv;
}

}  // namespace dynasurf::report
