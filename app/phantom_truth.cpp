#include "phantom_truth.hpp"

#include <algorithm>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/report/measures.hpp"

#include "true_walls.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json vector_json(const Vec3& v) { return {v[0], v[1], v[2]}; }

Json true_motion(const synthetic::Phantom& phantom) {
  if (!phantom.tracked) return nullptr;
  const synthetic::TrackedTruth& t = *phantom.tracked;
  return {{"points", t.points.name.size()},
          {"apex_mm", vector_json(t.apex)},
          {"base_mm", vector_json(t.base)},
          {"twist_deg", t.twist_deg}};
}

/// What of the wall is true per segment, in the words of results.json; nothing that is read from counts.
Json true_regions(const synthetic::Phantom& phantom) {
  if (!phantom.axis) return nullptr;
  Json json = report::measures_json(measure_true_walls(phantom), phantom.study.cycle_ms);
  for (Json& segment : json["segments"]) {
    segment.erase("count_thickening_percent"), segment.erase("phase_counts_deg");
    for (auto at = segment.begin(); at != segment.end();)
      at = at.key().ends_with("_90") ? segment.erase(at) : std::next(at);
  }
  json["phase"].erase("counts");
  for (Json& phase : json["phase"])
    if (phase.is_object()) phase.erase("sd_deg_90");  // too few gates have no phase
  return {{"phase", json["phase"]}, {"segments", json["segments"]}};
}

float largest_value(const Study& study) {
  float largest = 0;
  for (const Image& gate : study.gates)
    for (const float value : gate.values) largest = std::max(largest, value);
  return largest;
}

}  // namespace

Json options_of(const synthetic::Phantom& phantom) {
  synthetic::PhantomOptions options = phantom.options;
  const ChoiceRef kinds = choice_of(options);
  return io::options_to_json(kinds.choose(kinds.current()));
}

Json truth_of(const synthetic::Phantom& phantom) {
  Json json = Json::object();
  json["schema"] = "dynasurf.phantom/1";
  json["kind"] = phantom.kind;
  json["edv_ml"] = number(phantom.edv_ml);
  json["esv_ml"] = number(phantom.esv_ml);
  json["ef_percent"] = number(phantom.ef_percent);
  json["beat_edv_ml"] = number(phantom.beat_edv_ml);
  json["beat_esv_ml"] = number(phantom.beat_esv_ml);
  json["beat_ef_percent"] = number(phantom.beat_ef_percent);
  json["fwhm_mm"] = phantom.fwhm_mm;
  json["missing_fraction"] = phantom.missing_fraction;
  json["gates"] = Json::array();
  for (std::size_t g = 0; g < phantom.truth.size(); ++g) {
    const synthetic::TrueGate& gate = phantom.truth[g];
    json["gates"].push_back({{"gate", g + 1},
                             {"time_ms", phantom.study.time_ms.empty() ? Json() : Json(phantom.study.time_ms[g])},
                             {"phase", gate.phase},
                             {"endo_ml", gate.endo_ml},
                             {"epi_ml", gate.epi_ml},
                             {"wall_ml", gate.wall_ml()}});
  }
  json["regions"] = true_regions(phantom);
  json["tracked"] = true_motion(phantom);
  json["notes"] = Json::array();
  for (const Note& note : phantom.notes) json["notes"].push_back({{"code", note.code}, {"message", note.message}});
  json["program"] = {{"name", "dynasurf"}, {"version", version()}, {"commit", commit()}};
  json["options"] = options_of(phantom);
  return json;
}

void write_true_labels(const synthetic::Phantom& phantom, const report::LabelOutput& labels,
                       const std::filesystem::path& folder) {
  if (labels.ending.empty()) return;
  std::vector<report::GateWalls> walls;
  for (const synthetic::TrueGate& gate : phantom.truth) {
    if (gate.endo.triangles.empty() || gate.epi.triangles.empty())
      throw OptionError("--labels: the phantom '" + phantom.kind + "' has not both walls");
    walls.push_back({&gate.endo, &gate.epi});
  }
  report::write_wall_labels(walls, phantom.study, labels, folder);
}

Study without_negative(Study study) {
  for (Image& gate : study.gates)
    for (float& value : gate.values) value = std::max(0.0F, value);
  return study;
}

io::DicomWriteOptions finely_stored(const Study& study, const std::string& description) {
  const float largest = largest_value(study);
  io::DicomWriteOptions dicom;
  dicom.counts_scale = largest > 0 ? 30000 / static_cast<double>(largest) : 1;
  dicom.series_description = description;
  // No list of corrections says what was not corrected.
  if (study.attenuation == Attenuation::uncorrected) dicom.series_description += " NAC";
  return dicom;
}

}  // namespace dynasurf::app
