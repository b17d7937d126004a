#include "dynasurf/mesh/motion.hpp"

#include <cmath>
#include <filesystem>
#include <memory>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/mesh/detail/point_spline.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/report/detail/motion_results.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "result_job.hpp"
#include "result_walls.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

struct MotionArguments {
  std::string points, result;
  std::vector<double> apex, base;
  int rest_gate = 1;
  ResultArguments output;
};

/// Where the long axis lies: as told, or as a result found it.
ventricle::LongAxis axis_of(const MotionArguments& a, const std::optional<ResultWalls>& walls) {
  if (!a.apex.empty()) return {{a.apex[0], a.apex[1], a.apex[2]}, {a.base[0], a.base[1], a.base[2]}, 0};
  if (!walls) throw OptionError("where the long axis lies is not told; expected --result, or --apex and --base");
  if (!walls->axes) throw InputError(a.result + ": the axis does not leave both surfaces");
  constexpr double length_sd_mm = 3;  // apex and valve plane of a result lie within some 2 mm each
  return {walls->axes->apex, walls->axes->base(), length_sd_mm};
}

void write_moved(const TriMesh& rest, const mesh::SplineMotion& motion, const std::string& name, const fs::path& folder,
                 const std::vector<io::MeshFormat>& formats, std::vector<double>& volumes_ml) {
  TriMesh now = rest;
  for (Vec3& p : now.vertices) p = motion.at(p);
  volumes_ml.push_back(mesh::volume_mm3(now) / 1000);
  const mesh::SurfaceMotion moved = mesh::surface_motion(rest, now);
  const auto floats = [](const std::vector<double>& v) { return std::vector<float>(v.begin(), v.end()); };
  const std::vector<io::VertexScalar> scalars{{"displacement_mm", floats(moved.displacement_mm)},
                                              {"inward_mm", floats(moved.inward_mm)},
                                              {"area_strain_percent", floats(moved.area_strain_percent)}};
  for (const io::MeshFormat format : formats)
    io::write_mesh(now, folder / (name + "." + std::string(word_of(format))), format, scalars);
}

/// The surfaces of the gate at rest in all gates, carried along by the points.
void carry_surfaces(const TrackedPoints& points, const ResultWalls& walls, int rest_gate, const fs::path& folder,
                    const std::vector<io::MeshFormat>& formats, report::MotionRun& run) {
  const mesh::PointSpline spline(points.gates[rest_gate]);
  for (std::size_t g = 0; g < points.gates.size(); ++g) {
    const mesh::SplineMotion motion = spline.motion_to(points.gates[g]);
    const std::string gate = (g < 9 ? "_g0" : "_g") + std::to_string(g + 1);
    write_moved(walls.endo, motion, "endo" + gate, folder, formats, run.cavity_ml);
    write_moved(walls.epi, motion, "epi" + gate, folder, formats, run.outer_ml);
  }
}

/// A wall is 8 mm and more thick: how much it thickens is not seen by points that lie nearly as far apart.
void note_spacing(report::MotionRun& run) {
  constexpr double farthest_mm = 3;
  if (run.motion.spacing_mm > farthest_mm)
    run.notes.push_back({Severity::info, "motion.radial_strain_low",
                         "points lie " + fixed(run.motion.spacing_mm, 1) +
                             " mm from the nearest other one, too far for radial strain, which reads low"});
}

/// Without a sign where it rounds to nothing.
std::string unsigned_zero(double value) { return fixed(std::abs(value) < 0.05 ? 0 : value, 1); }

std::string summary_of(const report::MotionRun& run) {
  std::vector<std::vector<std::string>> rows{
      {"gate", "apex deg", "mid deg", "base deg", "twist deg", "deg/cm", "radial %", "circumf. %", "longit. %"}};
  for (std::size_t g = 0; g < run.motion.gates.size(); ++g) {
    const ventricle::GateMotion& gate = run.motion.gates[g];
    std::vector<std::string> row{std::to_string(g + 1)};
    for (const auto& level : gate.levels) row.push_back(level ? unsigned_zero(level->rotation_deg) : "-");
    for (const double value : {gate.twist_deg, gate.torsion_deg_per_cm, gate.strains.radial_percent,
                               gate.strains.circumferential_percent, gate.strains.longitudinal_percent})
      row.push_back(unsigned_zero(value));
    rows.push_back(row);
  }
  const ventricle::GateMotion& peak = run.motion.gates[run.motion.peak_gate];
  std::string text = table(rows) + "largest twist " + fixed(peak.twist_deg, 1) +
                     " deg (90 %: " + fixed(peak.twist_deg - 1.645 * peak.twist_sd_deg, 1) + " to " +
                     fixed(peak.twist_deg + 1.645 * peak.twist_sd_deg, 1) + ") in gate " +
                     std::to_string(run.motion.peak_gate + 1) + ", from " + std::to_string(run.points) + " points\n";
  for (const Note& note : run.notes) text += line_of(note) + "\n";
  return text + "Research use only. Not for diagnosis.\n";
}

ExitCode run(const MotionArguments& a, std::stop_token stop) {
  const ThreadLimit limit(a.output.threads);
  if (a.apex.empty() != a.base.empty()) throw OptionError("--apex and --base belong together; one is missing");
  ResultJob job;
  job.mesh_formats = {io::MeshFormat::ply, io::MeshFormat::vtp};
  take(a.output, "dynasurf motion", job);
  io::TrackedFile tracked = io::read_tracked_points(a.points);
  std::vector<fs::path> inputs{a.points};
  if (!a.result.empty()) inputs.push_back(fs::path(a.result) / "results.json");
  io::OutputFolder folder(job.out, job.existing, inputs);
  std::optional<ResultWalls> walls;
  if (!a.result.empty()) walls = read_result_walls(a.result, a.rest_gate);
  report::MotionRun run;
  run.axis = axis_of(a, walls);
  run.points = tracked.points.name.size();
  run.notes = std::move(tracked.notes);
  run.motion = ventricle::measure_motion(tracked.points, run.axis, a.rest_gate - 1);
  note_spacing(run);
  if (walls) carry_surfaces(tracked.points, *walls, a.rest_gate - 1, folder.path() / "meshes", job.mesh_formats, run);
  const std::string json = io::json_text(report::motion_json(run, provenance_of(job, inputs, "")));
  io::write_file(folder.path() / "results.json", json);
  io::write_file(folder.path() / "motion.svg", report::motion_svg(run.motion));
  if (stop.stop_requested()) throw Cancelled("stopped on request");
  folder.publish();
  print_result(a.output, json, summary_of(run), folder.moved_to());
  return done;
}

}  // namespace

void add_motion(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<MotionArguments>();
  CommandLine command(program, "motion",
                      "Twist, torsion and strain from points that were tracked over the beat (tagged MR)");
  command.option("POINTS", a->points, "table with the columns point, gate, x_mm, y_mm, z_mm (LPS)").required();
  command.option("--result", a->result,
                 "folder written by dynasurf ventricle: tells the long axis; its surfaces are carried along");
  const auto place = [&](const char* name, std::vector<double>& at, const char* what) {
    command.option(name, at, what).list_of(3).one_value();
  };
  place("--apex", a->apex, "x,y,z in mm: the long axis's end at the apex, at rest");
  place("--base", a->base, "x,y,z in mm: its end at the valve plane");
  command.option("--rest-gate", a->rest_gate, "the gate that motion counts from").within(1, 1000);
  add_result_arguments(command, a->output, "ply and vtp, with --result");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
