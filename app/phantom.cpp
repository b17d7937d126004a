#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/io/tracked_points_io.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/camera.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

#include "command.hpp"
#include "console.hpp"
#include "label_arguments.hpp"
#include "out_argument.hpp"
#include "phantom_patients.hpp"
#include "phantom_truth.hpp"
#include "result_job.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Arguments {
  std::string kind;
  OutFolder out;
  std::vector<std::string> settings;
  std::string seed;
  int threads = 0, count = 0, repeats = 1;
  bool nrrd = false, quiet = false, small = false;
  report::LabelOutput labels;
};

ExitCode make_population(const Arguments& a, const std::stop_token& stop) {
  if (a.nrrd) throw OptionError("--nrrd: patients are written as DICOM alone");
  if (a.out.replace)
    throw OptionError("--replace: patients that stand at --out are kept, and those that lack are added");
  if (a.count < 1) throw OptionError("phantom patients needs --count N, how many patients");
  return make_patients({a.out.path, a.count, a.repeats, a.seed, a.settings, a.small, a.quiet, a.labels}, stop);
}

/// `--seed` is short for the one option of the kind that is called noise.seed, wherever it stands.
std::string path_of_seed(const OptionNodes& nodes, const std::string& kind) {
  for (const OptionRow& row : option_table(nodes))
    if (("." + row.path).ends_with(".noise.seed")) return row.path;
  throw OptionError("--seed: the phantom '" + kind + "' draws no random numbers");
}

synthetic::PhantomOptions options_of(const Arguments& arguments) {
  synthetic::PhantomOptions phantom;
  const ChoiceRef kinds = choice_of(phantom);
  const OptionNodes nodes = kinds.choose(position_of(kinds.methods, arguments.kind, "KIND"));
  for (const std::string& setting : arguments.settings) set_option(nodes, setting);
  if (!arguments.seed.empty()) set_option(nodes, path_of_seed(nodes, arguments.kind) + "=" + arguments.seed);
  return phantom;
}

void write_surfaces(const synthetic::Phantom& phantom, const fs::path& folder) {
  for (std::size_t g = 0; g < phantom.truth.size(); ++g) {
    const std::string ending = (g < 9 ? "_g0" : "_g") + std::to_string(g + 1) + ".ply";
    const synthetic::TrueGate& gate = phantom.truth[g];
    if (!gate.endo.triangles.empty())
      io::write_mesh(gate.endo, folder / "truth" / ("endo" + ending), io::MeshFormat::ply);
    if (!gate.epi.triangles.empty()) io::write_mesh(gate.epi, folder / "truth" / ("epi" + ending), io::MeshFormat::ply);
  }
}

void write_phantom(const synthetic::Phantom& phantom, const Arguments& arguments, const fs::path& folder) {
  io::write_dicom(phantom.study, folder / "study.dcm",
                  finely_stored(phantom.study, "Dynasurf phantom " + phantom.kind));
  io::write_nifti(phantom.study, folder / "study.nii.gz");
  if (arguments.nrrd)
    io::write_nrrd(phantom.study, folder / (phantom.study.gates.size() > 1 ? "study.seq.nrrd" : "study.nrrd"));
  if (phantom.tracked) io::write_tracked_points(phantom.tracked->points, folder / "points.csv");
  io::write_file(folder / "truth.json", io::json_text(truth_of(phantom)));
  write_surfaces(phantom, folder);
  write_true_labels(phantom, arguments.labels, folder / "labels");
}

std::string summary_of(const synthetic::Phantom& phantom) {
  std::vector<std::vector<std::string>> rows{{"gate", "endo_ml", "epi_ml", "wall_ml"}};
  for (std::size_t g = 0; g < phantom.truth.size(); ++g) {
    const synthetic::TrueGate& gate = phantom.truth[g];
    rows.push_back({std::to_string(g + 1), fixed(gate.endo_ml, 1), fixed(gate.epi_ml, 1), fixed(gate.wall_ml(), 1)});
  }
  std::string text = table(rows);
  if (phantom.ef_percent)
    text += "true EDV " + fixed(*phantom.edv_ml, 1) + " mL  ESV " + fixed(*phantom.esv_ml, 1) + " mL  EF " +
            fixed(*phantom.ef_percent, 1) + " %\n";
  for (const Note& note : phantom.notes) text += line_of(note) + "\n";
  return text;
}

synthetic::CloudPhantom cloud_options_of(const Arguments& arguments) {
  synthetic::CloudPhantom options;
  for (const std::string& setting : arguments.settings) set_option(options, setting);
  if (!arguments.seed.empty()) set_option(options, "seed=" + arguments.seed);
  return options;
}

/// A scan with its truth: the points, and the surface they were taken from.
ExitCode make_scan(const Arguments& arguments, std::stop_token stop) {
  if (arguments.nrrd) throw OptionError("--nrrd: the phantom 'cloud' is no volume");
  const synthetic::CloudPhantom options = cloud_options_of(arguments);
  io::OutputFolder folder(arguments.out.path, arguments.out.existing());
  const TriMesh reference = synthetic::cloud_reference(options.shape);
  const PointCloud cloud = synthetic::make_cloud(options);
  io::write_cloud(cloud, folder.path() / "cloud.ply");
  io::write_mesh(reference, folder.path() / "truth" / "surface.ply", io::MeshFormat::ply);
  Json json = Json::object();
  json["schema"] = "dynasurf.phantom/1";
  json["kind"] = "cloud";
  json["points"] = cloud.points.size();
  json["genus"] = synthetic::genus_of(options.shape);
  json["volume"] = mesh::volume_mm3(reference);
  json["area"] = mesh::area_mm2(reference);
  json["triangles"] = reference.triangles.size();
  json["program"] = {{"name", "dynasurf"}, {"version", version()}, {"commit", commit()}};
  json["options"] = io::parse_json(io::options_to_text(options), "the options");
  io::write_file(folder.path() / "truth.json", io::json_text(json));
  if (stop.stop_requested()) throw Cancelled("stopped on request");
  folder.publish();
  if (!arguments.quiet)
    print(std::string(word_of(options.shape)) + ": " + std::to_string(cloud.points.size()) + " points, genus " +
          std::to_string(synthetic::genus_of(options.shape)) + "\nphantom: " + arguments.out.path + "\n" +
          line_of_moved(folder));
  return done;
}

synthetic::CameraPhantom camera_options_of(const Arguments& arguments) {
  synthetic::CameraPhantom options;
  for (const std::string& setting : arguments.settings) set_option(options, setting);
  if (!arguments.seed.empty()) set_option(options, "seed=" + arguments.seed);
  return options;
}

/// The truth of the patient, in which the camera's options and what follows of them take the place of the patient's.
Json truth_of_camera(const synthetic::CameraStudy& made, const synthetic::CameraPhantom& options) {
  const synthetic::Collimator collimator = synthetic::collimator_of(options.acquisition);
  Json json = truth_of(made.truth);
  json.erase("fwhm_mm");
  json["camera"] = {{"fwhm_at_100_mm", synthetic::fwhm_at(synthetic::response_of(collimator), 100)},
                    {"sensitivity_cps_per_mbq", synthetic::sensitivity_cps_per_mbq(collimator)},
                    {"angle_deg", made.projections.angle_deg},
                    {"radius_mm", made.projections.radius_mm}};
  json["options"] = io::parse_json(io::options_to_text(options), "the options");
  return json;
}

/// A patient before the camera: projections, slices, truth.
ExitCode make_acquisition(const Arguments& arguments, std::stop_token stop) {
  const synthetic::CameraPhantom options = camera_options_of(arguments);
  io::OutputFolder folder(arguments.out.path, arguments.out.existing());
  synthetic::CameraStudy made;
  run_with_progress(arguments.quiet, stop,
                    [&](const Progress& progress) { made = synthetic::make_camera_study(options, progress); });
  const fs::path to = folder.path();
  io::DicomWriteOptions counts;
  counts.series_description = "Dynasurf projections";
  io::write_projections(made.projections, to / "projections.dcm", counts);
  io::write_dicom(made.transaxial, to / "transaxial.dcm", finely_stored(made.transaxial, "Dynasurf transaxial"));
  io::write_dicom(made.short_axis, to / "study.dcm", finely_stored(made.short_axis, "Dynasurf short axis"));
  if (arguments.nrrd)
    io::write_nrrd(made.short_axis, to / (made.short_axis.gates.size() > 1 ? "study.seq.nrrd" : "study.nrrd"));
  Study map;
  map.gates = {made.attenuation};
  io::write_nrrd(map, to / "attenuation.nrrd");
  io::write_file(to / "truth.json", io::json_text(truth_of_camera(made, options)));
  if (made.truth.tracked) io::write_tracked_points(made.truth.tracked->points, to / "points.csv");
  write_surfaces(made.truth, to);
  if (stop.stop_requested()) throw Cancelled("stopped on request");
  folder.publish();
  if (!arguments.quiet) print(summary_of(made.truth) + "phantom: " + arguments.out.path + "\n" + line_of_moved(folder));
  return done;
}

ExitCode run(const Arguments& arguments, std::stop_token stop) {
  const ThreadLimit limit(arguments.threads);
  report::check_labels(arguments.labels, "--labels");
  if (arguments.kind == "patients") return make_population(arguments, stop);
  if (arguments.count > 0 || arguments.small || arguments.repeats > 1)
    throw OptionError("--count, --repeats and --small belong to phantom patients");
  if (!arguments.labels.ending.empty() &&
      (arguments.kind == "cloud" || arguments.kind == synthetic::CameraPhantom::name))
    throw OptionError("--labels: the phantom '" + arguments.kind + "' has no walls on the grid of its study");
  if (arguments.kind == "cloud") return make_scan(arguments, stop);
  if (arguments.kind == synthetic::CameraPhantom::name) return make_acquisition(arguments, stop);
  const synthetic::PhantomOptions options = options_of(arguments);
  io::OutputFolder folder(arguments.out.path, arguments.out.existing());
  const synthetic::Phantom phantom = synthetic::make_phantom(options);
  write_phantom(phantom, arguments, folder.path());
  if (stop.stop_requested()) throw Cancelled("stopped on request");
  folder.publish();
  if (!arguments.quiet) print(summary_of(phantom) + "phantom: " + arguments.out.path + "\n" + line_of_moved(folder));
  return done;
}

std::string kinds_text() {
  synthetic::PhantomOptions phantom;
  std::string text;
  for (const std::string_view kind : choice_of(phantom).methods) text.append(text.empty() ? "" : ", ").append(kind);
  return text +
         ", patients: many with a table of their truth, camera: projections of a patient, or cloud: points of a "
         "scanned body";
}

}  // namespace

void add_phantom(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand("phantom", "Make a synthetic study or scan with known truth");
  command->add_option("KIND", a->kind, kinds_text())->required();
  add_out_folder(
      *command, a->out,
      "folder for study.dcm, study.nii.gz (camera: projections.dcm, transaxial.dcm, attenuation.nrrd; cloud: "
      "cloud.ply), truth.json, the true surfaces, and points.csv of patients with tags")
      ->required();
  command->add_option("--set", a->settings, "set one option: path=value; may be repeated (see: dynasurf options)")
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--seed", a->seed, "seed of the noise; the same seed gives the same bytes");
  command->add_option("--threads", a->threads, "threads at most; the result is the same (0: all)")
      ->check(CLI::Range(0, 1024));
  command->add_option("--count", a->count, "patients: how many; those that stand at --out are kept")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--repeats", a->repeats, "patients: studies of each, with other noise and another pose")
      ->check(CLI::Range(1, 100));
  command->add_flag("--small", a->small, "patients: 4 gates of 40 x 40 x 20 voxels, for quick cohorts");
  add_label_arguments(*command, a->labels);
  command->add_flag("--nrrd", a->nrrd, "write the study as NRRD too");
  command->add_flag("--quiet", a->quiet, "print nothing");
  command->callback([a, &chosen] { chosen = [a](std::stop_token stop) { return run(*a, stop); }; });
}

}  // namespace dynasurf::app
