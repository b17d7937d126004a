#include "summary.hpp"

#include <algorithm>

#include "dynasurf/ventricle/measures/measures.hpp"

#include "console.hpp"
#include "look_at.hpp"

namespace dynasurf::app {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// "111.0 +- 4.2", or "111.0" where no interval is known.
std::string cell_of(const std::optional<heart::Estimate>& e) {
  if (!e) return "-";
  return fixed(e->value, 1) + (e->has_interval() ? " +- " + fixed(e->high() - e->value, 1) : "");
}

/// "EDV 111.0 mL (gate 1)  ESV ...": what the result says, in one line; empty where the study is not gated.
std::string leading_of(const ventricle::Result& result) {
  const ventricle::Reading& r = result.leading;
  if (!r.ef_percent) return "";
  const auto gate = [](const std::optional<int>& g) {
    return g ? " (gate " + std::to_string(*g + 1) + ")" : std::string();
  };
  return "EDV " + fixed(r.edv_ml->value, 1) + " mL" + gate(r.ed_gate) + "  ESV " + fixed(r.esv_ml->value, 1) + " mL" +
         gate(r.es_gate) + "  SV " + fixed(r.sv_ml->value, 1) + " mL  EF " + fixed(r.ef_percent->value, 1) + " %\n";
}

/// The same study read in three ways, a line each, the leading one first; with 90 % intervals where they are known.
std::string readings_of(const ventricle::Readings& readings) {
  Rows rows{{"reading", "EDV mL", "ESV mL", "SV mL", "EF %", "wall mL"}};
  const auto add = [&](const char* name, const ventricle::Reading& r) {
    if (r.ef_percent || r.wall_ml)
      rows.push_back(
          {name, cell_of(r.edv_ml), cell_of(r.esv_ml), cell_of(r.sv_ml), cell_of(r.ef_percent), cell_of(r.wall_ml)});
  };
  if (readings.psf_corrected) add("PSF-corrected, 90 %", ventricle::reading_of(*readings.psf_corrected));
  add("edge", readings.edge);
  if (readings.gaussian_profile) add("Gaussian profile", ventricle::reading_of(*readings.gaussian_profile));
  return rows.size() > 1 ? table(rows, {0}) : std::string();
}

/// Volumes gate by gate: of the leading surfaces, and beside them of the edges where another reading leads.
std::string gates_of(const ventricle::Result& result) {
  const bool edge_leads = result.leading.kind == ventricle::ReadingKind::edge;
  Rows rows{{"gate", "time_ms", "endo_ml", "epi_ml", "wall_ml"}};
  if (!edge_leads) rows[0].insert(rows[0].end(), {"edge endo_ml", "edge epi_ml", "edge wall_ml"});
  rows[0].push_back("on border");
  const auto number = [](const auto& value, int decimals) {
    return value ? fixed(*value, decimals) : std::string("-");
  };
  for (const ventricle::Gate& gate : result.gates) {
    const ventricle::EdgeSurfaces& edge = gate.edge_surfaces;
    const auto leading = [&](const std::optional<ventricle::LeadingSurface>& s) {
      return s ? cell_of(s->volume_ml) : "-";
    };
    const auto& [endo, epi, base] = gate.surfaces;
    const std::string wall = endo && epi ? fixed(epi->volume_ml.value - endo->volume_ml.value, 1) : "-";
    std::vector<std::string> row{std::to_string(gate.gate + 1), number(gate.time_ms, 0), leading(endo), leading(epi),
                                 wall};
    const auto volume = [](const std::optional<ventricle::Surface>& s) {
      return s ? fixed(s->volume_ml, 1) : std::string("-");
    };
    if (!edge_leads) row.insert(row.end(), {volume(edge.endo), volume(edge.epi), number(edge.wall_ml, 1)});
    double stopped = 1;
    for (const auto* surface : {&edge.endo, &edge.epi})
      if (*surface) stopped = std::min(stopped, (*surface)->stopped_fraction);
    row.push_back(edge.endo || edge.epi ? fixed(100 * stopped, 1) + " %" : "-");
    rows.push_back(std::move(row));
  }
  return table(rows);
}

}  // namespace

std::string summary_of(const ventricle::Result& result) {
  const auto number = [](const auto& value, int decimals) {
    return value ? fixed(*value, decimals) : std::string("-");
  };
  std::string text = gates_of(result);
  if (result.measures && result.measures->function) {
    const ventricle::VolumeCurveFit& f = *result.measures->function;
    text += "fit of " + std::to_string(f.waves) + " waves: EDV " + fixed(f.edv_ml, 1) + " mL  ESV " +
            fixed(f.esv_ml, 1) + " mL  EF " + number(f.ef_percent, 1) + " %";
    if (const auto rate = ventricle::per_second(f.peak_filling, result.study.cycle_ms))
      text += "  PFR " + fixed(*rate, 2) + " EDV/s  TTPF " + fixed(f.time_to_peak_filling * result.study.cycle_ms, 0) +
              " ms";
    text += "\n";
  }
  if (result.measures && result.measures->phase_counts)
    text += "muscle " + number(result.measures->muscle_g, 0) + " g" +
            (result.measures->from_edges ? " between the edges" : "") + "  phase SD " +
            fixed(result.measures->phase_counts->sd_deg, 1) + " deg  bandwidth " +
            fixed(result.measures->phase_counts->bandwidth_deg, 0) + " deg\n";
  if (result.measures && result.measures->cavity_alone && result.measures->phase_motion)
    text += "phase SD of the motion " + fixed(result.measures->phase_motion->sd_deg, 1) + " deg  bandwidth " +
            fixed(result.measures->phase_motion->bandwidth_deg, 0) + " deg\n";
  text += readings_of(result.readings) + leading_of(result);
  text += "verdict: " + std::string(word_of(result.verdict)) + "\n";
  if (const std::string first = look_at(result); !first.empty()) text += "  " + first + "\n";
  for (const ventricle::QualityFlag& flag : result.flags)
    text += "  " + std::string(name_of(flag.severity)) + ": " + flag.message + " [" + flag.code + "]\n";
  std::size_t remarks = 0;
  for (const Note& note : result.notes) {
    const bool flagged = std::any_of(result.flags.begin(), result.flags.end(),
                                     [&](const ventricle::QualityFlag& flag) { return flag.code == note.code; });
    if (note.severity == Severity::info) ++remarks;
    // The flag "surface_missing" names these gates in one line.
    const bool is_told = flagged || note.code == "labels.no_endo" || note.code == "labels.no_epi";
    if (note.severity != Severity::info && !is_told) text += "  " + line_of(note) + "\n";
  }
  if (remarks > 0) text += "  " + std::to_string(remarks) + " remarks in results.json and report.html\n";
  return text + "Research use only. Not for diagnosis.\n";
}

}  // namespace dynasurf::app
