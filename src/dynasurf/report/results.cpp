#include <algorithm>
#include <cmath>
#include <tuple>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/report/detail/json_parts.hpp"
#include "dynasurf/report/measures.hpp"
#include "dynasurf/report/report.hpp"

namespace dynasurf::report {
namespace {

using namespace detail;

Json study_json(const Study& study) {
  Json json = Json::object();
  json["format"] = study.format;
  json["modality"] = study.modality;
  json["image_type"] = study.image_type;
  json["view"] = name_of(study.view);
  json["attenuation"] = name_of(study.attenuation);
  json["gates"] = study.gates.size();
  json["cycle_ms"] = study.cycle_ms > 0 ? number(study.cycle_ms) : Json(nullptr);
  if (study.gates.empty()) {
    json["dims"] = json["spacing_mm"] = nullptr;
  } else {
    json["dims"] = study.grid().dims;
    json["spacing_mm"] = vector_json(study.grid().spacing);
  }
  return json;
}

Json triangles_json(const TriMesh& mesh, const mesh::TriangleQuality& q) {
  Json json = Json::object();
  json["count"] = mesh.triangles.size();
  json["area_mean_mm2"] = number(q.area_mean);
  json["area_min_mm2"] = number(q.area_min);
  json["area_max_mm2"] = number(q.area_max);
  json["d_mean_mm"] = number(q.d_mean);
  json["d_min_mm"] = number(q.d_min);
  json["d_max_mm"] = number(q.d_max);
  json["shape_mean"] = number(q.shape_mean);
  json["shape_min"] = number(q.shape_min);
  json["smallest_angle_deg"] = number(q.smallest_angle_deg);
  return json;
}

Json validity_json(const mesh::Repair& repair) {
  Json json = Json::object();
  json["closed"] = repair.check.closed;
  json["manifold"] = repair.check.manifold;
  json["oriented"] = repair.check.oriented;
  json["self_intersections"] = repair.check.self_intersections;
  json["flat_triangles"] = repair.check.flat_triangles;
  json["vertices_tidied"] = repair.tidied.vertices_moved;
  json["vertices_untangled"] = repair.untangled.vertices_moved;
  json["largest_move_mm"] = number(std::max(repair.tidied.largest_move_mm, repair.untangled.largest_move_mm));
  return json;
}

/// The volume of a surface that was joined from contours, in three ways, mL.
Json stack_json(const std::optional<mesh::StackVolumes>& stack) {
  if (!stack) return nullptr;
  return {{"trapezoid_ml", number(stack->trapezoid / 1000)},
          {"gauss_ml", number(stack->gauss / 1000)},
          {"triangle_exact_ml", number(stack->triangle_exact / 1000)}};
}

Json surface_json(const std::optional<ventricle::Surface>& surface) {
  if (!surface) return nullptr;
  Json json = Json::object();
  json["volume_ml"] = number(surface->volume_ml);
  json["vertices"] = surface->mesh.vertices.size();
  json["stop_reason"] = dynamics::name_of(surface->stop_reason);
  json["steps"] = surface->steps;
  json["step_s"] = number(surface->step_s);
  json["step_explained"] = surface->step_explained;
  json["stopped_fraction"] = number(surface->stopped_fraction);
  json["within_one_voxel"] = number(surface->within_one_voxel);
  json["border_reached"] = number(surface->border_reached);
  json["mean_distance_mm"] = number(surface->mean_distance_mm);
  json["contour_volumes"] = stack_json(surface->stack);
  json["triangles"] = triangles_json(surface->mesh, surface->quality);
  json["validity"] = validity_json(surface->repair);
  return json;
}

Json heart_json(const std::optional<heart::Location>& heart) {
  if (!heart) return nullptr;
  Json json = Json::object();
  json["center_mm"] = vector_json(heart->cup.middle());
  json["axis"] = vector_json(heart->cup.axis);
  json["apex_mm"] = vector_json(heart->cup.apex());
  json["radius_mm"] = number(heart->cup.radius_mm);
  json["contrast"] = number(heart->contrast);
  json["ridge_share"] = number(heart->ridge_share);
  json["runner_up"] = number(heart->runner_up);
  json["other_end"] = number(heart->other_end);
  return json;
}

Json plane_json(const std::optional<heart::BasePlane>& plane) {
  if (!plane) return nullptr;
  Json json = Json::object();
  json["point_mm"] = vector_json(plane->point);
  json["normal"] = vector_json(plane->normal);
  json["spread_mm"] = number(plane->spread_mm);
  json["seen"] = number(plane->seen);
  return json;
}

Json interval_json(const heart::Estimate& e) {
  return e.has_interval() ? Json{number(e.low()), number(e.high())} : Json(nullptr);
}

/// A number with its 90 % interval, null where none is known.
void put_estimate(Json& json, const std::string& name, const std::optional<heart::Estimate>& e) {
  json[name] = e ? number(e->value) : Json(nullptr);
  json[name + "_90"] = e ? interval_json(*e) : Json(nullptr);
}

/// The worse of the two surfaces, so that one number per gate cannot hide a bad one.
template <class Member, class Worse>
Json worst(const ventricle::EdgeSurfaces& surfaces, Member member, Worse worse) {
  std::optional<double> value;
  for (const auto* surface : {&surfaces.endo, &surfaces.epi})
    if (*surface) value = value ? worse(*value, member(**surface)) : member(**surface);
  return number(value);
}

/// The edge surfaces of a gate: how they were found, and what they enclose.
Json edge_json(const ventricle::EdgeSurfaces& surfaces) {
  const auto least = [](double a, double b) { return std::min(a, b); };
  const auto most = [](double a, double b) { return std::max(a, b); };
  Json json = Json::object();
  json["endo_ml"] = surfaces.endo ? number(surfaces.endo->volume_ml) : Json(nullptr);
  json["epi_ml"] = surfaces.epi ? number(surfaces.epi->volume_ml) : Json(nullptr);
  json["wall_ml"] = number(surfaces.wall_ml);
  json["stopped_fraction"] = worst(
      surfaces, [](const ventricle::Surface& s) { return s.stopped_fraction; }, least);
  json["mean_distance_mm"] = worst(
      surfaces, [](const ventricle::Surface& s) { return s.mean_distance_mm; }, most);
  json["triangle_shape_min"] = worst(
      surfaces, [](const ventricle::Surface& s) { return s.quality.shape_min; }, least);
  json["base_plane"] = plane_json(surfaces.base_plane);
  json["endo"] = surface_json(surfaces.endo);
  json["epi"] = surface_json(surfaces.epi);
  return json;
}

std::optional<heart::Estimate> volume_of(const std::optional<ventricle::LeadingSurface>& surface) {
  return surface ? std::optional(surface->volume_ml) : std::nullopt;
}

Json gate_json(const ventricle::Gate& gate) {
  const std::optional<heart::Estimate> endo = volume_of(gate.surfaces.endo), epi = volume_of(gate.surfaces.epi);
  Json json = Json::object();
  json["gate"] = one_based(gate.gate);
  json["time_ms"] = number(gate.time_ms);
  put_estimate(json, "endo_ml", endo);
  put_estimate(json, "epi_ml", epi);
  json["wall_ml"] = endo && epi ? number(epi->value - endo->value) : Json(nullptr);
  json["base_plane"] = plane_json(gate.surfaces.base_plane);
  json["division_slice"] = one_based(gate.labels.division_slice);
  json["base_slice"] = one_based(gate.base_slice);
  json["edge"] = edge_json(gate.edge_surfaces);
  return json;
}

/// The notes of the run, then those of the study and of the labels that it does not repeat.
Notes all_notes(const ventricle::Result& result) {
  Notes notes = result.notes;
  const auto add = [&notes](Note note, int gate) {
    if (note.gate < 0) note.gate = gate;
    const auto key = [](const Note& n) { return std::tie(n.severity, n.code, n.message, n.slice); };
    // A note that stands there without its gate is the same note.
    const bool known = std::any_of(notes.begin(), notes.end(), [&](const Note& n) {
      return key(n) == key(note) && (n.gate == note.gate || n.gate < 0);
    });
    if (!known) notes.push_back(std::move(note));
  };
  for (const Note& note : result.study.notes) add(note, -1);
  for (const ventricle::Gate& gate : result.gates)
    for (const Note& note : gate.labels.notes) add(note, gate.gate);
  return notes;
}

Json quality_json(const ventricle::Result& result) {
  Json flags = Json::array();
  for (const ventricle::QualityFlag& flag : result.flags)
    flags.push_back({{"severity", name_of(flag.severity)},
                     {"code", flag.code},
                     {"message", flag.message},
                     {"value", number(flag.value)}});
  return {{"verdict", word_of(result.verdict)},
          {"wall_variation", number(result.wall_variation)},
          {"flags", std::move(flags)}};
}

Json phases_json(const std::optional<heart::CurvePhases>& phases) {
  if (!phases) return nullptr;
  return {{"end_diastole", one_based(phases->end_diastole)},
          {"end_systole", one_based(phases->end_systole)},
          {"end_rapid_filling", one_based(phases->end_rapid_filling)}};
}

/// The numbers that every reading has.
void put_reading(Json& json, const ventricle::Reading& reading) {
  put_estimate(json, "edv_ml", reading.edv_ml);
  put_estimate(json, "esv_ml", reading.esv_ml);
  put_estimate(json, "sv_ml", reading.sv_ml);
  put_estimate(json, "ef_percent", reading.ef_percent);
  put_estimate(json, "wall_ml", reading.wall_ml);
  json["ed_gate"] = one_based(reading.ed_gate);
  json["es_gate"] = one_based(reading.es_gate);
}

Json reading_json(const ventricle::Reading& reading) {
  Json json = Json::object();
  put_reading(json, reading);
  return json;
}

Json fit_json(const std::optional<psf_fit::FittedBeat>& fit) {
  if (!fit) return nullptr;
  Json json = reading_json(ventricle::reading_of(*fit));
  put_estimate(
      json, "wall_g",
      heart::Estimate{ventricle::muscle_density * fit->wall_ml.value, ventricle::muscle_density * fit->wall_ml.sd});
  put_estimate(json, "thickness_mm", fit->thickness_mm);
  put_estimate(json, "fwhm_mm", fit->fwhm_mm);
  json["wall_variation"] = number(fit->wall_variation);
  json["cavity"] = number(fit->cavity);
  json["background"] = number(fit->background);
  json["extracardiac_sources"] = fit->extracardiac_sources;
  json["thickness_from_data"] = number(fit->thickness_from_data);
  json["width_from_data"] = number(fit->width_from_data);
  json["steps"] = fit->steps;
  json["converged"] = fit->converged;
  return json;
}

Json readings_json(const ventricle::Readings& readings) {
  Json json = Json::object();
  json["psf_corrected"] = fit_json(readings.psf_corrected);
  json["edge"] = reading_json(readings.edge);
  json["gaussian_profile"] =
      readings.gaussian_profile ? reading_json(ventricle::reading_of(*readings.gaussian_profile)) : Json(nullptr);
  return json;
}

Json timings_json(const ventricle::Result& result, Timings timings) {
  if (timings == Timings::omit) return nullptr;
  Json json = Json::object();
  for (const auto& [stage, seconds] : result.seconds) json[stage] = number(seconds);
  return json;
}

}  // namespace

// The published schema (docs/results.schema.json) names every key that stands here, and the tables of cohorts follow
// from it.
Json results_json(const ventricle::Result& result, const Provenance& provenance, Timings timings) {
  Json gates = Json::array();
  for (const ventricle::Gate& gate : result.gates) gates.push_back(gate_json(gate));

  Json json = Json::object();
  json["schema"] = "dynasurf.ventricle/3";
  json["use"] = "Research use only. Not for diagnosis.";
  json["reading"] = word_of(result.leading.kind);
  put_reading(json, result.leading);
  json["phases"] = phases_json(result.phases);
  json["readings"] = readings_json(result.readings);
  json["heart"] = heart_json(result.heart);
  json["quality"] = quality_json(result);
  json["notes"] = placed_notes_json(all_notes(result));
  json["gates"] = std::move(gates);
  json["measures"] = measures_json(result.measures, result.study.cycle_ms);
  json["study"] = study_json(result.study);
  json["provenance"] = provenance_json(provenance);
  json["timings_s"] = timings_json(result, timings);
  return json;
}

}  // namespace dynasurf::report
