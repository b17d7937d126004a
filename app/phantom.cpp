#include <memory>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/synthetic/camera.hpp"

#include "console.hpp"
#include "label_arguments.hpp"
#include "phantom_parts.hpp"
#include "phantom_patients.hpp"
#include "phantom_truth.hpp"
#include "result_job.hpp"

namespace dynasurf::app {

namespace fs = std::filesystem;

void write_surfaces(const synthetic::Phantom& phantom, const fs::path& folder) {
  for (std::size_t g = 0; g < phantom.truth.size(); ++g) {
    const std::string ending = (g < 9 ? "_g0" : "_g") + std::to_string(g + 1) + ".ply";
    const synthetic::TrueGate& gate = phantom.truth[g];
    if (!gate.endo.triangles.empty())
      io::write_mesh(gate.endo, folder / "truth" / ("endo" + ending), io::MeshFormat::ply);
    if (!gate.epi.triangles.empty()) io::write_mesh(gate.epi, folder / "truth" / ("epi" + ending), io::MeshFormat::ply);
  }
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

namespace {

ExitCode make_population(const PhantomArguments& a, const std::stop_token& stop) {
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

synthetic::PhantomOptions options_of(const PhantomArguments& arguments) {
  synthetic::PhantomOptions phantom;
  const ChoiceRef kinds = choice_of(phantom);
  const OptionNodes nodes = kinds.choose(position_of(kinds.methods, arguments.kind, "KIND"));
  set_options(nodes, arguments.settings);
  if (!arguments.seed.empty()) set_option(nodes, path_of_seed(nodes, arguments.kind) + "=" + arguments.seed);
  return phantom;
}

void write_phantom(const synthetic::Phantom& phantom, const PhantomArguments& arguments, const fs::path& folder) {
  io::write_dicom(without_negative(phantom.study), folder / "study.dcm",
                  finely_stored(phantom.study, "Dynasurf phantom " + phantom.kind));
  io::write_nifti(phantom.study, folder / "study.nii.gz");
  if (arguments.nrrd)
    io::write_nrrd(phantom.study, folder / (phantom.study.gates.size() > 1 ? "study.seq.nrrd" : "study.nrrd"));
  if (phantom.tracked) io::write_tracked_points(phantom.tracked->points, folder / "points.csv");
  io::write_file(folder / "truth.json", io::json_text(truth_of(phantom)));
  write_surfaces(phantom, folder);
  write_true_labels(phantom, arguments.labels, folder / "labels");
}

ExitCode run(const PhantomArguments& arguments, std::stop_token stop) {
  const ThreadLimit limit(arguments.threads);
  report::check_labels(arguments.labels, "--labels");
  if (arguments.kind == "patients") return make_population(arguments, stop);
  if (arguments.count > 0 || arguments.small || arguments.repeats > 1)
    throw OptionError("--count, --repeats and --small belong to phantom patients");
  if (!arguments.labels.ending.empty() &&
      (arguments.kind == "cloud" || arguments.kind == "terrain" || arguments.kind == synthetic::CameraPhantom::name))
    throw OptionError("--labels: the phantom '" + arguments.kind + "' has no walls on the grid of its study");
  if (arguments.kind == "cloud") return make_scan(arguments, stop);
  if (arguments.kind == "terrain") return make_terrain(arguments, stop);
  if (arguments.kind == synthetic::CameraPhantom::name) return make_acquisition(arguments, stop);
  const synthetic::PhantomOptions options = options_of(arguments);
  io::OutputFolder folder(arguments.out.path, arguments.out.existing());
  const synthetic::Phantom phantom = synthetic::make_phantom(options);
  write_phantom(phantom, arguments, folder.path());
  // A folder that is not published goes, with all that was made.
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
         ", patients: many with a table of their truth, camera: projections of a patient, cloud: points of a "
         "scanned body, or terrain: hills with spikes to smooth";
}

}  // namespace

void add_phantom(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<PhantomArguments>();
  CommandLine command(program, "phantom", "Make a synthetic study or scan with known truth");
  command.option("KIND", a->kind, kinds_text()).required();
  add_out_folder(
      command, a->out,
      "folder for study.dcm, study.nii.gz (camera: projections.dcm, transaxial.dcm, attenuation.nrrd; cloud: "
      "cloud.ply, terrain: terrain.ply), truth.json, the true surfaces, and points.csv of patients with tags")
      .required();
  command.option("--set", a->settings, "set one option: path=value; may be repeated (see: dynasurf options)")
      .repeated();
  command.option("--seed", a->seed, "seed of the noise; the same seed gives the same bytes");
  command.option("--threads", a->threads, "threads at most; the result is the same (0: all)").within(0, 1024);
  command.option("--count", a->count, "patients: how many; those that stand at --out are kept").within(1, 1000000);
  command.option("--repeats", a->repeats, "patients: studies of each, with other noise and another pose")
      .within(1, 100);
  command.flag("--small", a->small, "patients: 4 gates of 40 x 40 x 20 voxels, for quick cohorts");
  add_label_arguments(command, a->labels);
  command.flag("--nrrd", a->nrrd, "write the study as NRRD too");
  command.flag("--quiet", a->quiet, "print nothing");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
