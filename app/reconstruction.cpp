#include "reconstruction.hpp"

#include <algorithm>
#include <ctime>
#include <functional>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/atomic_file.hpp"
#include "dynasurf/io/byte_source.hpp"
#include "dynasurf/io/json_read.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/report/dicom_folder.hpp"
#include "dynasurf/report/leading_walls.hpp"
#include "dynasurf/report/measures.hpp"

#include "console.hpp"
#include "option_arguments.hpp"
#include "print_page.hpp"
#include "sheets.hpp"
#include "stages.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string gate_file(std::string_view wall, std::size_t gate, MeshFormat format) {
  const std::string number = (gate + 1 < 10 ? "0" : "") + std::to_string(gate + 1);
  return std::string(wall) + "_g" + number + "." + std::string(word_of(format));
}

/// Surfaces that can be shown between the gates: one for every gate, with the same triangles.
bool is_cycle(const std::vector<TriMesh>& meshes, std::size_t gates) {
  return meshes.size() == gates && std::all_of(meshes.begin(), meshes.end(),
                                               [&](const TriMesh& m) { return m.triangles == meshes[0].triangles; });
}

/// Seconds of one beat: as measured, else one second.
double cycle_s(const Study& study) { return study.cycle_ms > 0 ? study.cycle_ms / 1000 : 1.0; }

/// How much thicker the wall is at each vertex than at end diastole, percent; empty where the vertices are others.
std::vector<float> thickening_of(const Measures& m, const VertexThickness& now, Wall wall) {
  if (m.ed_gate < 0) return {};
  const WallThickness& rest = m.gates[static_cast<std::size_t>(m.ed_gate)].thickness;
  const std::vector<double>& before = wall == Wall::endo ? rest.endo.mm : rest.epi.mm;
  std::vector<float> percent;
  if (before.size() != now.mm.size()) return percent;
  for (std::size_t v = 0; v < before.size(); ++v)
    percent.push_back(before[v] > 0 ? static_cast<float>(100 * (now.mm[v] / before[v] - 1)) : 0.0F);
  return percent;
}

/// What is known of every vertex of a measured surface: its thickness, its segment, its way since end diastole.
std::vector<VertexScalar> scalars_of(const VentricleResult& result, std::size_t gate, Wall wall, const TriMesh& mesh) {
  if (!result.measures || !result.measures->gates[gate].axes) return {};
  const GateMeasures& measured = result.measures->gates[gate];
  const VertexThickness& thickness = wall == Wall::endo ? measured.thickness.endo : measured.thickness.epi;
  const std::vector<int> segments = segments_of_vertices(result.measures->model, *measured.axes, mesh.vertices);
  std::vector<VertexScalar> scalars{{"segment", {segments.begin(), segments.end()}}};
  if (!thickness.mm.empty()) scalars.push_back({"thickness_mm", {thickness.mm.begin(), thickness.mm.end()}});
  if (const auto& motion = wall == Wall::endo ? measured.endo_motion : measured.epi_motion) {
    scalars.push_back({"inward_mm", {motion->inward_mm.begin(), motion->inward_mm.end()}});
    scalars.push_back({"displacement_mm", {motion->displacement_mm.begin(), motion->displacement_mm.end()}});
    scalars.push_back(
        {"area_strain_percent", {motion->area_strain_percent.begin(), motion->area_strain_percent.end()}});
  }
  if (const auto thickening = thickening_of(*result.measures, thickness, wall); !thickening.empty())
    scalars.push_back({"thickening_percent", thickening});
  return scalars;
}

/// The slices of end-diastole and end-systole with the walls that lead, for the page of two studies.
void write_splash(const VentricleResult& result, const fs::path& folder) {
  const int ed = result.fit ? result.fit->ed_gate : result.ed_gate.value_or(0);
  const int es = result.fit ? result.fit->es_gate : result.es_gate.value_or(ed);
  std::vector<SplashRow> rows;
  for (const auto& [name, gate] : {std::pair("end diastole", ed), std::pair("end systole", es)}) {
    if (!rows.empty() && es == ed) break;
    const auto g = static_cast<std::size_t>(gate);
    const report_detail::GateWalls walls = report_detail::leading_walls(result, g);
    if (walls.endo || walls.epi) rows.push_back({name, &result.study.gates[g], walls.endo, walls.epi});
  }
  if (!rows.empty()) write_png(draw_splash(rows), folder / "measures" / "splash.png");
}

void write_measures(const VentricleResult& result, const fs::path& folder) {
  if (!result.measures || result.measures->segments.empty()) return;
  const Measures& m = *result.measures;
  write_file(folder / "measures" / "segments.csv", segments_csv(m));
  write_file(folder / "measures" / "polar.csv", polar_csv(m));
  if (m.function) write_file(folder / "measures" / "curve.csv", curve_csv(*m.function));
  for (const PolarKind& kind : polar_kinds())
    if (!(m.maps.*kind.values).empty())
      write_file(folder / "measures" / ("polar_" + std::string(kind.name) + ".svg"), polar_svg(m, kind));
  if (const std::string svg = phase_histogram_svg(m); !svg.empty())
    write_file(folder / "measures" / "phase_histogram.svg", svg);
  write_splash(result, folder);
}

/// The fitted wall of one gate, with what was measured on it and the uptake that was fitted.
void write_fitted(const VentricleResult& result, std::size_t gate, Wall wall, const Job& job, const fs::path& folder) {
  const FittedGate& fitted = result.fit->gates[gate];
  const TriMesh& mesh = wall == Wall::endo ? fitted.endo : fitted.epi;
  std::vector<VertexScalar> scalars = scalars_of(result, gate, wall, mesh);
  scalars.push_back({"uptake", {result.fit->uptake.begin(), result.fit->uptake.end()}});
  for (const MeshFormat format : job.mesh_formats)
    write_mesh(mesh, folder / "meshes" / ("fit_" + gate_file(name_of(wall), gate, format)), format, scalars);
}

void write_surfaces(const VentricleResult& result, const Job& job, const fs::path& folder) {
  std::vector<PvdEntry> series;
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const Gate& gate = result.gates[g];
    const double time = gate.time_ms ? *gate.time_ms : static_cast<double>(g);
    for (const Wall wall : {Wall::endo, Wall::epi}) {
      const auto& surface = wall == Wall::endo ? gate.endo : gate.epi;
      if (!surface) continue;
      // What was measured on fitted walls is no scalar of the edges.
      const std::vector<VertexScalar> scalars =
          result.fit ? std::vector<VertexScalar>() : scalars_of(result, g, wall, surface->mesh);
      if (result.fit) write_fitted(result, g, wall, job, folder);
      for (const MeshFormat format : job.mesh_formats) {
        const std::string file = "meshes/" + gate_file(name_of(wall), g, format);
        write_mesh(surface->mesh, folder / file, format, scalars);
        if (format == MeshFormat::vtp) series.push_back({time, file, wall == Wall::endo ? 0 : 1});
      }
    }
  }
  if (!series.empty()) write_pvd(series, folder / "cycle.pvd");
}

/// Walls that are missing in a gate have no cycle to show.
void write_cycle(const VentricleResult& result, const fs::path& folder) {
  std::vector<AnimatedSurface> surfaces;
  const auto add = [&](Wall wall, std::array<float, 4> colour) {
    AnimatedSurface surface{std::string(name_of(wall)), colour, {}};
    for (const Gate& gate : result.gates)
      if (const auto& s = wall == Wall::endo ? gate.endo : gate.epi) surface.cycle.push_back(s->mesh);
    if (is_cycle(surface.cycle, result.gates.size())) surfaces.push_back(std::move(surface));
  };
  add(Wall::endo, {0.75F, 0.12F, 0.10F, 1.0F});
  add(Wall::epi, {0.85F, 0.75F, 0.65F, 0.35F});
  if (!surfaces.empty()) write_glb(surfaces, cycle_s(result.study), folder / "cycle.glb");
}

/// The meshes between the gates that `keyframes.frames_between` asks for, all walls that are complete.
void write_keyframes(const VentricleResult& result, const Job& job, const fs::path& folder) {
  const Keyframes& keyframes = job.options.keyframes;
  if (keyframes.frames_between == 0 || result.gates.size() < 2) return;
  const std::size_t steps = static_cast<std::size_t>(keyframes.frames_between) + 1;
  const std::size_t frames = steps * result.gates.size();
  const auto digits = std::to_string(frames).size();
  for (const Wall wall : {Wall::endo, Wall::epi}) {
    std::vector<TriMesh> cycle;
    for (const Gate& gate : result.gates)
      if (const auto& s = wall == Wall::endo ? gate.endo : gate.epi) cycle.push_back(s->mesh);
    if (!is_cycle(cycle, result.gates.size())) continue;
    for (std::size_t f = 0; f < frames; ++f) {
      const TriMesh mesh =
          at_phase(cycle, static_cast<double>(f) / static_cast<double>(frames), keyframes.interpolation);
      std::string number = std::to_string(f + 1);
      number.insert(0, digits - number.size(), '0');
      for (const MeshFormat format : job.mesh_formats)
        write_mesh(
            mesh,
            folder / "keyframes" / (std::string(name_of(wall)) + "_f" + number + "." + std::string(word_of(format))),
            format);
    }
  }
}

/// The hash of a file that was given beside the study; null when none was.
Json hash_of(const fs::path& file) { return file.empty() ? Json(nullptr) : Json(sha256_of_file(file)); }

/// The time DICOM results tell: as an earlier run told it; now; or, where equal runs shall give equal bytes, the
/// study's.
std::string dicom_time(const Job& job, bool study_is_dicom) {
  if (!job.outputs.dicom_time.empty()) return job.outputs.dicom_time;
  if (!job.timings) {
    const DicomSubject subject = study_is_dicom ? read_dicom_subject(job.study) : DicomSubject();
    const bool is_told = subject.study_date.size() == 8 && subject.study_time.size() >= 6;
    return is_told ? subject.study_date + subject.study_time.substr(0, 6) : "20000101000000";
  }
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[16];
  std::strftime(text, sizeof text, "%Y%m%d%H%M%S", &local);
  return text;
}

/// Whose DICOM results these are, and what their UIDs are made from: the inputs, the options, the program, the time.
DicomResult dicom_context(const Job& job, const Provenance& provenance, bool study_is_dicom) {
  DicomResult context;
  context.program_version = provenance.program_version;
  context.date = job.outputs.dicom_time.substr(0, 8);
  context.time = job.outputs.dicom_time.substr(8);
  Hasher hasher;
  const auto add = [&](const std::string& text) { hasher.add(text.data(), text.size() + 1); };
  for (const InputFile& input : provenance.inputs) add(input.sha256);
  for (const std::string& text : {provenance.options_json, provenance.program_version, provenance.commit,
                                  job.outputs.dicom_time, hash_of(job.mask).dump(), hash_of(job.start_mesh).dump()})
    add(text);
  context.content = hasher.finish();
  context.subject =
      study_is_dicom ? read_dicom_subject(job.study) : nameless_subject(context.content, context.date, context.time);
  return context;
}

/// What is made from the finished report and result: the printed pages, and the DICOM objects, which hold them.
void write_for_reading_room(const VentricleResult& result, const Provenance& provenance, const Job& job,
                            const fs::path& folder, const std::stop_token& stop) {
  if (job.outputs.pdf) print_page(folder / "report.html", folder / "report.pdf", stop);
  if (!job.outputs.dicom) return;
  write_dicom_folder(result, dicom_context(job, provenance, result.study.format == "DICOM"),
                     job.outputs.pdf ? text_of_file(folder / "report.pdf") : std::string(), folder / "dicom");
}

std::string results_text(const VentricleResult& result, const Provenance& provenance, const Job& job) {
  const Outputs& outputs = job.outputs;
  Json json = results_json(result, provenance, job.timings ? Timings::keep : Timings::omit);
  Json formats = Json::array();
  for (const MeshFormat format : job.mesh_formats) formats.push_back(word_of(format));
  json["provenance"]["given"] = {{"mask_sha256", hash_of(job.mask)}, {"start_mesh_sha256", hash_of(job.start_mesh)}};
  json["provenance"]["outputs"] = {{"mesh_formats", formats},
                                   {"keep_stages", outputs.keep_stages},
                                   {"dicom", outputs.dicom},
                                   // Without timings it is the study's, which a repeated run reads there again.
                                   {"dicom_time", outputs.dicom && job.timings ? Json(outputs.dicom_time) : Json()},
                                   {"pdf", outputs.pdf}};
  return json_text(json);
}

/// Every file of a usual result. They know nothing of each other: the page takes as long as all others together.
void write_files(const Outcome& outcome, const Provenance& provenance, const Job& job, const fs::path& folder) {
  const VentricleResult& result = outcome.result;
  const std::function<void()> writers[] = {
      // The page tells no times, so that equal runs give equal pages.
      [&] { write_report(result, provenance, folder / "report.html", Timings::omit); },
      [&] { write_surfaces(result, job, folder); },
      [&] { write_measures(result, folder); },
      [&] { write_cycle(result, folder); },
      [&] { write_keyframes(result, job, folder); },
      [&] {
        write_file(folder / "options.json", provenance.options_json);
        write_file(folder / "results.json", outcome.json);
        write_file(folder / "results.csv", results_csv(result));
      }};
  parallel_for(std::size(writers), 1, [&](std::size_t n, std::size_t) { writers[n](); });
}

}  // namespace

std::vector<std::string> hashes_of_study(const fs::path& study) {
  std::vector<std::string> hashes;
  for (const fs::path& file : files_of_study(study)) hashes.push_back(sha256_of_file(file));
  return hashes;
}

namespace {

/// Every file the run reads.
std::vector<fs::path> inputs_of(const Job& job) {
  std::vector<fs::path> inputs{job.study};
  for (const fs::path& given : {job.mask, job.start_mesh, job.options_file})
    if (!given.empty()) inputs.push_back(given);
  return inputs;
}

}  // namespace

Outcome reconstruct_to_folder(const Job& asked, const Progress& progress) {
  Job job = asked;
  const ThreadLimit limit(job.threads);
  if (job.outputs.pdf) find_browser();  // its absence, too, is told first
  // First, so that a place that cannot be written to costs no time.
  OutputFolder folder(job.out, job.existing, inputs_of(job));
  const Study study = read_study(job.study);
  if (job.outputs.dicom) job.outputs.dicom_time = dicom_time(job, study.format == "DICOM");
  const Provenance provenance = provenance_of(job, files_of_study(job.study), options_to_text(job.options));
  progress.check();

  std::optional<TriMesh> start;
  if (!job.start_mesh.empty()) start = read_mesh(job.start_mesh);
  std::optional<Image> mask;
  if (!job.mask.empty()) mask = read_mask(job.mask);

  const StageWriter stages(folder.path() / "stages");
  Outcome outcome;
  const StageSink keep =
      job.outputs.keep_stages ? StageSink([&](const Stages& s) { stages(s, job.options); }) : StageSink();
  try {
    outcome.result =
        reconstruct(study, job.options, progress, keep, start ? &*start : nullptr, mask ? &*mask : nullptr);
  } catch (const InputError& error) {  // the library knows the study, not the file it came from
    throw InputError(job.study.string() + ": " + error.what());
  }
  progress.check();
  outcome.json = results_text(outcome.result, provenance, job);
  write_files(outcome, provenance, job, folder.path());
  write_for_reading_room(outcome.result, provenance, job, folder.path(), progress.stop);
  progress.check();
  folder.publish();
  outcome.moved_to = folder.moved_to();
  return outcome;
}

namespace {

/// The same study read in three ways, a line each; what was not read has none.
std::string readings_of(const VentricleResult& result) {
  const auto cell = [](const Estimate& e) { return fixed(e.value, 1) + " +- " + fixed(e.high() - e.value, 1); };
  if (result.gates.size() == 1 && result.fit) {  // not gated
    const Gate& gate = result.gates.front();
    return table({{"reading", "cavity mL", "wall mL"},
                  {"unbiased, 90 %", cell(result.fit->edv_ml), cell(result.fit->wall_ml)},
                  {"classic edge", fixed(gate.endo->volume_ml, 1), fixed(*gate.wall_ml, 1)}},
                 {0});
  }
  std::vector<std::vector<std::string>> rows{{"reading", "EDV mL", "ESV mL", "SV mL", "EF %", "wall mL"}};
  if (result.fit && result.fit->ef_percent) {
    const FittedBeat& fit = *result.fit;
    rows.push_back({"unbiased, 90 %", cell(fit.edv_ml), cell(fit.esv_ml), cell(fit.sv_ml), cell(*fit.ef_percent),
                    cell(fit.wall_ml)});
  }
  const auto mean = [](const std::vector<double>& walls) {
    double sum = 0;
    for (const double w : walls) sum += w;
    return walls.empty() ? std::string("-") : fixed(sum / static_cast<double>(walls.size()), 1);
  };
  if (result.ef_percent) {
    std::vector<double> walls;
    for (const Gate& gate : result.gates)
      if (gate.wall_ml) walls.push_back(*gate.wall_ml);
    rows.push_back({"classic edge", fixed(*result.edv_ml, 1), fixed(*result.esv_ml, 1), fixed(*result.sv_ml, 1),
                    fixed(*result.ef_percent, 1), mean(walls)});
  }
  const auto qgs = result.qgs_like ? left_ventricular_function(result.qgs_like->cavity_ml) : std::nullopt;
  if (qgs && qgs->ef_percent)
    rows.push_back({"QGS-like", fixed(qgs->edv_ml, 1), fixed(qgs->esv_ml, 1), fixed(qgs->sv_ml, 1),
                    fixed(*qgs->ef_percent, 1), mean(result.qgs_like->wall_ml)});
  return rows.size() > 1 ? table(rows, {0}) : std::string();
}

/// Volumes gate by gate: of the surfaces on the edges, and before them of the fit where there is one.
std::string gates_of(const VentricleResult& result) {
  std::vector<std::string> header{"gate", "time_ms"};
  if (result.fit) header.insert(header.end(), {"unbiased_ml", "+-"});
  const std::string of = result.fit ? "edge " : "";
  header.insert(header.end(), {of + "endo_ml", of + "epi_ml", of + "wall_ml", "on border"});
  std::vector<std::vector<std::string>> rows{header};
  const auto number = [](const auto& value, int decimals) {
    return value ? fixed(static_cast<double>(*value), decimals) : std::string("-");
  };
  for (std::size_t n = 0; n < result.gates.size(); ++n) {
    const Gate& gate = result.gates[n];
    const auto volume = [](const std::optional<Surface>& s) { return s ? fixed(s->volume_ml, 1) : std::string("-"); };
    double stopped = 1;
    for (const auto* surface : {&gate.endo, &gate.epi})
      if (*surface) stopped = std::min(stopped, (*surface)->stopped_fraction);
    std::vector<std::string> row{std::to_string(gate.gate + 1), number(gate.time_ms, 0)};
    if (result.fit) {
      const Estimate& cavity = result.fit->gates[n].endo_ml;
      row.insert(row.end(), {fixed(cavity.value, 1), fixed((cavity.high() - cavity.low()) / 2, 1)});
    }
    row.insert(row.end(), {volume(gate.endo), volume(gate.epi), number(gate.wall_ml, 1),
                           gate.endo || gate.epi ? fixed(100 * stopped, 1) + " %" : "-"});
    rows.push_back(row);
  }
  return table(rows);
}

}  // namespace

std::string summary_of(const VentricleResult& result) {
  const auto number = [](const auto& value, int decimals) {
    return value ? fixed(static_cast<double>(*value), decimals) : std::string("-");
  };
  std::string text = gates_of(result);
  const auto gate_text = [](const std::optional<int>& gate) {
    return gate ? " (gate " + std::to_string(*gate + 1) + ")" : std::string();
  };
  if (result.ef_percent && !result.fit)
    text += "EDV " + number(result.edv_ml, 1) + " mL" + gate_text(result.ed_gate) + "  ESV " +
            number(result.esv_ml, 1) + " mL" + gate_text(result.es_gate) + "  SV " + number(result.sv_ml, 1) +
            " mL  EF " + number(result.ef_percent, 1) + " %\n";
  if (result.measures && result.measures->function) {
    const CycleFunction& f = *result.measures->function;
    text += "fit of " + std::to_string(f.waves) + " waves: EDV " + fixed(f.edv_ml, 1) + " mL  ESV " +
            fixed(f.esv_ml, 1) + " mL  EF " + number(f.ef_percent, 1) + " %";
    if (const auto rate = per_second(f.peak_filling, result.study.cycle_ms))
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
  text += readings_of(result);
  text += "verdict: " + std::string(word_of(result.verdict)) + "\n";
  for (const Flag& flag : result.flags)
    text += "  " + std::string(name_of(flag.severity)) + ": " + flag.message + " [" + flag.code + "]\n";
  std::size_t remarks = 0;
  for (const Note& note : result.notes) {
    const bool flagged =
        std::any_of(result.flags.begin(), result.flags.end(), [&](const Flag& flag) { return flag.code == note.code; });
    if (note.severity == Severity::info) ++remarks;
    if (note.severity != Severity::info && !flagged) text += "  " + line_of(note) + "\n";
  }
  if (remarks > 0) text += "  " + std::to_string(remarks) + " remarks in results.json and report.html\n";
  return text + "Research use only. Not for diagnosis.\n";
}

}  // namespace dynasurf::app
