#include <algorithm>
#include <functional>

#include <nlohmann/json.hpp>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/report/detail/splash.hpp"
#include "dynasurf/report/measures.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/report/result_folders.hpp"

namespace dynasurf::report {
namespace {

namespace fs = std::filesystem;

std::string gate_file(std::string_view wall, std::size_t gate, io::MeshFormat format) {
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
std::vector<float> thickening_of(const ventricle::Measures& m, const ventricle::VertexThickness& now,
                                 ventricle::Border wall) {
  if (m.ed_gate < 0) return {};
  const ventricle::WallThickness& rest = m.gates[m.ed_gate].thickness;
  const std::vector<double>& before = wall == ventricle::Border::endo ? rest.endo.mm : rest.epi.mm;
  std::vector<float> percent;
  if (before.size() != now.mm.size()) return percent;
  for (std::size_t v = 0; v < before.size(); ++v)
    percent.push_back(before[v] > 0 ? 100 * (now.mm[v] / before[v] - 1) : 0);
  return percent;
}

/// What is known of every vertex of a measured surface: its thickness, its segment, its way since end diastole.
std::vector<io::VertexScalar> scalars_of(const ventricle::Result& result, std::size_t gate, ventricle::Border wall,
                                         const TriMesh& mesh) {
  if (!result.measures || !result.measures->gates[gate].axes) return {};
  const ventricle::GateMeasures& measured = result.measures->gates[gate];
  const ventricle::VertexThickness& thickness =
      wall == ventricle::Border::endo ? measured.thickness.endo : measured.thickness.epi;
  const std::vector<int> segments =
      ventricle::segments_of_vertices(result.measures->model, *measured.axes, mesh.vertices);
  std::vector<io::VertexScalar> scalars{{"segment", {segments.begin(), segments.end()}}};
  if (!thickness.mm.empty()) scalars.push_back({"thickness_mm", {thickness.mm.begin(), thickness.mm.end()}});
  if (const auto& motion = wall == ventricle::Border::endo ? measured.endo_motion : measured.epi_motion) {
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
void write_splash(const ventricle::Result& result, const fs::path& folder) {
  const int ed = result.leading.ed_gate.value_or(0);
  const int es = result.leading.es_gate.value_or(ed);
  std::vector<SplashRow> rows;
  for (const int gate : {ed, es}) {
    if (!rows.empty() && es == ed) break;
    const auto& [endo, epi, base] = result.gates[gate].surfaces;
    if (endo || epi)
      rows.push_back({&result.study.gates[gate], endo ? &endo->mesh : nullptr, epi ? &epi->mesh : nullptr});
  }
  if (!rows.empty()) io::write_png(draw_splash(rows), folder / "measures" / "splash.png");
}

void write_measures(const ventricle::Result& result, const fs::path& folder) {
  if (!result.measures || result.measures->segments.empty()) return;
  const ventricle::Measures& m = *result.measures;
  io::write_file(folder / "measures" / "segments.csv", segments_csv(m));
  io::write_file(folder / "measures" / "polar.csv", polar_csv(m));
  if (m.function) io::write_file(folder / "measures" / "curve.csv", curve_csv(*m.function));
  for (const PolarKind& kind : polar_kinds())
    if (!(m.maps.*kind.values).empty())
      io::write_file(folder / "measures" / ("polar_" + std::string(kind.name) + ".svg"), polar_svg(m, kind));
  if (const std::string svg = phase_histogram_svg(m); !svg.empty())
    io::write_file(folder / "measures" / "phase_histogram.svg", svg);
  write_splash(result, folder);
}

void write_surfaces(const ventricle::Result& result, const StudyFolderOptions& options, const fs::path& folder) {
  std::vector<io::PvdEntry> series;
  const auto& beat = result.readings.psf_corrected;
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const ventricle::Gate& gate = result.gates[g];
    const double time = gate.time_ms ? *gate.time_ms : g;
    for (const ventricle::Border wall : {ventricle::Border::endo, ventricle::Border::epi}) {
      if (const auto& surface = gate.surfaces.of(wall)) {
        std::vector<io::VertexScalar> scalars = scalars_of(result, g, wall, surface->mesh);
        if (beat) scalars.push_back({"uptake", {beat->uptake.begin(), beat->uptake.end()}});
        for (const io::MeshFormat format : options.mesh_formats) {
          const std::string file = "meshes/" + gate_file(ventricle::name_of(wall), g, format);
          io::write_mesh(surface->mesh, folder / file, format, scalars);
          if (format == io::MeshFormat::vtp) series.push_back({time, file, wall == ventricle::Border::endo ? 0 : 1});
        }
      }
      if (const auto& edge = gate.edge_surfaces.of(wall); edge && beat)
        for (const io::MeshFormat format : options.mesh_formats)
          io::write_mesh(edge->mesh, folder / "meshes" / ("edge_" + gate_file(ventricle::name_of(wall), g, format)),
                         format);
    }
  }
  if (!series.empty()) io::write_pvd(series, folder / "cycle.pvd");
}

/// Walls that are missing in a gate have no cycle to show.
void write_cycle(const ventricle::Result& result, const fs::path& folder) {
  std::vector<io::AnimatedSurface> surfaces;
  const auto add = [&](ventricle::Border wall, std::array<float, 4> colour) {
    io::AnimatedSurface surface{std::string(ventricle::name_of(wall)), colour, {}};
    for (const ventricle::Gate& gate : result.gates)
      if (const auto& s = gate.surfaces.of(wall)) surface.cycle.push_back(s->mesh);
    if (is_cycle(surface.cycle, result.gates.size())) surfaces.push_back(std::move(surface));
  };
  add(ventricle::Border::endo, {0.75F, 0.12F, 0.10F, 1.0F});
  add(ventricle::Border::epi, {0.85F, 0.75F, 0.65F, 0.35F});
  if (!surfaces.empty()) io::write_glb(surfaces, cycle_s(result.study), folder / "cycle.glb");
}

/// The meshes between the gates that `keyframes.frames_between` asks for, all walls that are complete.
void write_keyframes(const ventricle::Result& result, const StudyFolderOptions& options, const fs::path& folder) {
  const mesh::Keyframes& keyframes = options.keyframes;
  if (keyframes.frames_between == 0 || result.gates.size() < 2) return;
  const std::size_t steps = keyframes.frames_between + 1;
  const std::size_t frames = steps * result.gates.size();
  const auto digits = std::to_string(frames).size();
  for (const ventricle::Border wall : {ventricle::Border::endo, ventricle::Border::epi}) {
    std::vector<TriMesh> cycle;
    for (const ventricle::Gate& gate : result.gates)
      if (const auto& s = gate.surfaces.of(wall)) cycle.push_back(s->mesh);
    if (!is_cycle(cycle, result.gates.size())) continue;
    for (std::size_t f = 0; f < frames; ++f) {
      const TriMesh mesh = mesh::at_phase(cycle, 1.0 * f / frames, keyframes.interpolation);
      std::string number = std::to_string(f + 1);
      number.insert(0, digits - number.size(), '0');
      for (const io::MeshFormat format : options.mesh_formats)
        io::write_mesh(mesh,
                       folder / "keyframes" /
                           (std::string(ventricle::name_of(wall)) + "_f" + number + "." + std::string(word_of(format))),
                       format);
    }
  }
}

}  // namespace

void write_study_files(const ventricle::Result& result, const Provenance& provenance, const StudyFolderOptions& options,
                       const fs::path& folder) {
  // They know nothing of each other: the page takes as long as all others together.
  const std::function<void()> writers[] = {
      [&] { write_report(result, provenance, folder / "report.html", Timings::omit); },
      [&] { write_surfaces(result, options, folder); },
      [&] { write_measures(result, folder); },
      [&] { write_cycle(result, folder); },
      [&] { write_keyframes(result, options, folder); },
      [&] {
        if (!provenance.options_json.empty()) io::write_file(folder / "options.json", provenance.options_json);
        io::write_file(folder / "results.json", options.results_text.empty()
                                                    ? io::json_text(results_json(result, provenance, options.timings))
                                                    : options.results_text);
        io::write_file(folder / "results.csv", results_csv(result));
      }};
  parallel_for_files(std::size(writers), [&](std::size_t n) { writers[n](); });
}

void write_study_folder(const ventricle::Result& result, const fs::path& out, const Provenance& provenance,
                        const StudyFolderOptions& options) {
  io::OutputFolder folder(out);
  write_study_files(result, provenance, options, folder.path());
  folder.publish();
}

}  // namespace dynasurf::report
