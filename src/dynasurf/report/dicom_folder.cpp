#include "dynasurf/report/detail/dicom_folder.hpp"

#include <algorithm>
#include <array>

#include "dynasurf/mesh/detail/fill_mesh.hpp"
#include "dynasurf/report/detail/numbers.hpp"

namespace dynasurf::report {
namespace {

using detail::text_of;
using Groups = std::vector<io::DicomMeasurementGroup>;
using Remarks = std::vector<std::pair<io::DicomCode, std::string>>;

// Terms of the standard's context groups for hearts; what they lack is the program's own.
const io::DicomCode end_diastolic{"8821-1", "LN", "Left Ventricular ED Volume"};
const io::DicomCode end_systolic{"8823-7", "LN", "Left Ventricular ES Volume"};
const io::DicomCode stroke_volume{"90096001", "SCT", "Stroke Volume"};
const io::DicomCode ejection_fraction{"10230-1", "LN", "Left Ventricular Ejection Fraction"};
const io::DicomCode mass{"18087-7", "LN", "Left Ventricle Mass"};
const io::DicomCode volume{"118565006", "SCT", "Volume"};
const io::DicomCode peak_ejection_rate{"122616", "DCM", "Peak Ejection Rate"};
const io::DicomCode peak_filling_rate{"122618", "DCM", "Peak Filling Rate"};
const io::DicomCode peak_filling_time{"122619", "DCM", "Peak Filling Time"};
const io::DicomCode perfusion{"251053005", "SCT", "Myocardial perfusion"};
const io::DicomCode left_ventricle{"87878005", "SCT", "Left Ventricle"};
const io::DicomCode myocardium{"49848007", "SCT", "Left Ventricle Myocardium"};
const io::DicomCode millilitre{"mL", "UCUM", "mL"}, percent{"%", "UCUM", "%"}, gram{"g", "UCUM", "g"};
const io::DicomCode per_second_unit{"/s", "UCUM", "/s"}, millisecond{"ms", "UCUM", "ms"},
    degree{"deg", "UCUM", "degree"};
const io::DicomCode millimetre{"mm", "UCUM", "mm"};

io::DicomCode own(const char* value, const char* meaning) { return {value, "99DYNASURF", meaning}; }

/// The segments of the AHA in SNOMED CT, from 1.
constexpr std::array<const char*, 17> segment_codes{
    "264850008", "396482007", "396646008", "264846001", "396652009", "396654005", "264848000", "396647004", "396649001",
    "264847005", "396655006", "396656007", "264844003", "264845002", "264849008", "264853005", "128564006"};

io::DicomCode site_of(ventricle::SegmentModel model, const ventricle::Segment& segment) {
  const std::string name = "Left ventricle " + std::string(segment.name);
  if (model == ventricle::SegmentModel::aha17) return {segment_codes[segment.number - 1], "SCT", name};
  return {"SEGMENT20_" + std::to_string(segment.number), "99DYNASURF", name};
}

void add(io::DicomMeasurementGroup& group, const io::DicomCode& what, const std::optional<double>& value,
         const io::DicomCode& unit) {
  if (value) group.measurements.push_back({what, *value, unit});
}

void add_interval(io::DicomMeasurementGroup& group, const char* name, const heart::Estimate& e, const char* unit) {
  group.remarks.push_back({own("INTERVAL_90", "90 % interval"), std::string(name) + ": " + text_of(e.low(), 1) +
                                                                    " to " + text_of(e.high(), 1) + " " + unit});
}

io::DicomMeasurementGroup group_of(std::string name, const io::DicomCode& site) {
  io::DicomMeasurementGroup group;
  group.name = std::move(name);
  group.site = site;
  return group;
}

struct ReadingTerms {
  const char *name, *code, *method;
};

/// What a reading is called, by its kind.
ReadingTerms terms_of(ventricle::ReadingKind kind) {
  switch (kind) {
    case ventricle::ReadingKind::psf_corrected:
      return {"PSF-corrected reading", "PSF_CORRECTED", "Surfaces of all gates fitted through the point spread"};
    case ventricle::ReadingKind::gaussian_profile:
      return {"Gaussian-profile reading", "GAUSSIAN_PROFILE", "65 % of the deviations of an asymmetric Gaussian"};
    case ventricle::ReadingKind::edge:
      break;
  }
  return {"Edge reading", "EDGE", "Where the blurred image is steepest"};
}

io::DicomMeasurementGroup group_of(const ventricle::Reading& reading) {
  const ReadingTerms terms = terms_of(reading.kind);
  io::DicomMeasurementGroup group = group_of(terms.name, left_ventricle);
  group.method = own(terms.code, terms.method);
  const auto add_value = [&](const io::DicomCode& what, const std::optional<heart::Estimate>& e,
                             const io::DicomCode& unit) {
    if (e) add(group, what, e->value, unit);
  };
  const auto add_bar = [&](const char* name, const std::optional<heart::Estimate>& e, const char* unit) {
    if (e && e->has_interval()) add_interval(group, name, *e, unit);
  };
  add_value(end_diastolic, reading.edv_ml, millilitre);
  add_value(end_systolic, reading.esv_ml, millilitre);
  add_value(stroke_volume, reading.sv_ml, millilitre);
  add_value(ejection_fraction, reading.ef_percent, percent);
  add_bar("EDV", reading.edv_ml, "mL");
  add_bar("ESV", reading.esv_ml, "mL");
  add_bar("EF", reading.ef_percent, "%");
  if (reading.kind == ventricle::ReadingKind::psf_corrected && reading.wall_ml)
    add(group, mass, ventricle::muscle_density * reading.wall_ml->value, gram);
  return group;
}

io::DicomMeasurementGroup beat_of(const ventricle::VolumeCurveFit& f, double cycle_ms) {
  io::DicomMeasurementGroup group = group_of("Periodic fit of the volume curve", left_ventricle);
  add(group, peak_ejection_rate, ventricle::per_second(f.peak_emptying, cycle_ms), per_second_unit);
  add(group, peak_filling_rate, ventricle::per_second(f.peak_filling, cycle_ms), per_second_unit);
  if (cycle_ms > 0) add(group, peak_filling_time, f.time_to_peak_filling * cycle_ms, millisecond);
  add(group, own("FIRST_THIRD_FILLING", "Share of the stroke volume back after a third of diastole"),
      100 * f.first_third_filling, percent);
  return group;
}

io::DicomMeasurementGroup phase_of(const char* name, const ventricle::PhaseSummary& phase) {
  io::DicomMeasurementGroup group = group_of(name, myocardium);
  add(group, own("PHASE_MEAN", "Mean of the phase"), phase.mean_deg, degree);
  add(group, own("PHASE_SD", "Standard deviation of the phase"), phase.sd_deg, degree);
  add(group, own("PHASE_BANDWIDTH", "Bandwidth of the phase"), phase.bandwidth_deg, degree);
  add(group, own("PHASE_ENTROPY", "Entropy of the phase"), phase.entropy_percent, percent);
  return group;
}

void add_measures(Groups& groups, const ventricle::Measures& m, double cycle_ms) {
  if (m.function) groups.push_back(beat_of(*m.function, cycle_ms));
  if (m.phase_counts) groups.push_back(phase_of("Phase of the counts", *m.phase_counts));
  if (m.phase_motion) groups.push_back(phase_of("Phase of the motion", *m.phase_motion));
  for (const ventricle::SegmentMeasures& s : m.segments) {
    io::DicomMeasurementGroup group =
        group_of("Segment " + std::to_string(s.segment.number), site_of(m.model, s.segment));
    add(group, perfusion, s.perfusion_percent, percent);
    add(group, own("THICKENING", "Thickening of the wall"), s.thickening_percent, percent);
    add(group, own("INWARD_MOTION", "Inward motion of the endocardium"), s.motion_mm, millimetre);
    groups.push_back(std::move(group));
  }
}

Groups readings_of(const ventricle::Result& result) {
  Groups groups;
  const ventricle::Readings& readings = result.readings;
  if (readings.psf_corrected) groups.push_back(group_of(ventricle::reading_of(*readings.psf_corrected)));
  groups.push_back(group_of(readings.edge));
  if (readings.gaussian_profile) groups.push_back(group_of(ventricle::reading_of(*readings.gaussian_profile)));
  if (result.measures) add_measures(groups, *result.measures, result.study.cycle_ms);
  return groups;
}

std::string two_digits(std::size_t gate) { return (gate + 1 < 10 ? "0" : "") + std::to_string(gate + 1); }

/// Voxels of which half or more lie inside.
Mask filled(const Grid& grid, const TriMesh& mesh) {
  const Image part = mesh::fill_mesh(grid, to_grid(grid, mesh), {4, 4, 1});
  Mask mask(grid);
  for (std::size_t v = 0; v < mask.values.size(); ++v) mask.values[v] = part.values[v] >= 0.5F;
  return mask;
}

bool is_empty(const Mask& mask) {
  return std::none_of(mask.values.begin(), mask.values.end(), [](std::uint8_t v) { return v != 0; });
}

/// Cavity and wall of a gate; nothing where a surface is missing or too small for a voxel.
std::vector<io::DicomSegment> segments_of_gate(const Grid& grid, const ventricle::LeadingSurfaces& walls) {
  if (!walls.endo || !walls.epi) return {};
  io::DicomSegment cavity{
      "Cavity of the left ventricle", left_ventricle, filled(grid, walls.endo->mesh), {30000, 28000, 20000}};
  io::DicomSegment wall{"Wall of the left ventricle", myocardium, filled(grid, walls.epi->mesh), {38000, 48000, 45000}};
  for (std::size_t v = 0; v < wall.mask.values.size(); ++v)
    // A voxel belongs to one segment: where the inner surface passes, the wall takes what the cavity leaves.
    if (cavity.mask.values[v] != 0) wall.mask.values[v] = 0;
  if (is_empty(cavity.mask) || is_empty(wall.mask)) return {};
  return {std::move(cavity), std::move(wall)};
}

/// Writes the segmentation of a gate and adds the volumes of its parts.
void add_gate(const ventricle::Result& result, const io::DicomResult& context, std::size_t g, Groups& groups,
              const std::filesystem::path& folder) {
  const ventricle::LeadingSurfaces& walls = result.gates[g].surfaces;
  const std::vector<io::DicomSegment> segments = segments_of_gate(result.study.grid(), walls);
  if (segments.empty()) return;
  const int gate_number = g + 1;
  const std::string gate = "gate " + std::to_string(gate_number);
  const io::DicomObject object{"segmentations", "segmentation " + gate,   802,
                               gate_number,     "Dynasurf segmentations", "Cavity and wall, " + gate};
  const io::DicomInstance written =
      io::write_segmentation(context, object, segments, folder / ("segmentation_g" + two_digits(g) + ".dcm"));
  const auto region = [&](const char* name, const io::DicomCode& site, int number, double ml) {
    io::DicomMeasurementGroup group = group_of(std::string(name) + ", " + gate, site);
    group.time_point = gate;
    group.segments = written;
    group.segment = number;
    add(group, volume, ml, millilitre);
    groups.push_back(std::move(group));
  };
  // Volumes of the surfaces themselves, which voxels only approximate.
  region("Cavity", left_ventricle, 1, walls.endo->volume_ml.value);
  region("Wall", myocardium, 2, walls.epi->volume_ml.value - walls.endo->volume_ml.value);
}

void write_surfaces(const ventricle::Result& result, const io::DicomResult& context,
                    const std::filesystem::path& folder) {
  int number = 0;
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    for (const ventricle::Border wall : {ventricle::Border::endo, ventricle::Border::epi}) {
      const auto& surface = result.gates[g].surfaces.of(wall);
      if (!surface) continue;
      const std::string name(ventricle::name_of(wall));
      const std::string words = name + "cardium of the left ventricle, gate " + std::to_string(g + 1);
      const io::DicomObject object{"surfaces", words, 803, ++number, "Dynasurf surfaces", words};
      io::write_encapsulated_stl(context, object, surface->mesh, folder / (name + "_g" + two_digits(g) + ".dcm"));
    }
  }
}

Remarks remarks_of(const ventricle::Result& result) {
  Remarks remarks{{own("USE", "Use"), "Research use only. Not for diagnosis."},
                  {own("VERDICT", "Verdict"), std::string(word_of(result.verdict))}};
  for (const ventricle::QualityFlag& flag : result.flags)
    remarks.push_back({own("FLAG", "Quality flag"), flag.message});
  return remarks;
}

}  // namespace

void write_dicom_folder(const ventricle::Result& result, io::DicomResult context, std::string_view pdf,
                        const std::filesystem::path& folder) {
  // Images without a frame of reference get one: surfaces and segmentations must share it.
  if (context.subject.frame_of_reference.empty())
    context.subject.frame_of_reference =
        io::instance_of(context, {"", "frame of reference", 1, 1, "", ""}, "").sop_instance;
  Groups groups = readings_of(result);
  for (std::size_t g = 0; g < result.gates.size(); ++g) add_gate(result, context, g, groups, folder);
  write_surfaces(result, context, folder);
  io::write_measurement_report(context,
                               {"measurements", "measurements", 801, 1, "Dynasurf measurements", "Measurements"},
                               groups, remarks_of(result), folder / "measurements.dcm");
  if (!pdf.empty())
    io::write_encapsulated_pdf(context, {"report", "report", 804, 1, "Dynasurf report", "Left ventricle report"}, pdf,
                               folder / "report.dcm");
}

}  // namespace dynasurf::report
