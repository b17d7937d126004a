#include "heart.hpp"

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/report/result_folders.hpp"
#include "dynasurf/ventricle/options.hpp"

#include "command_line.hpp"
#include "version.hpp"

namespace dynasurf::python {
namespace {

/// The command line that gives the same result, without paths. What a person can only do in Python is told by notes.
std::string command_of(const HeartRun& run) {
  std::string command = "dynasurf ventricle STUDY --out RESULT --preset " + run.preset;
  ventricle::Options options = run.options;
  if (run.start) {
    command += " --start MESH";
    options.placement.shape = ventricle::Options{}.placement.shape;  // --start says so
  }
  if (run.mask) command += " --mask MASK";
  for (const std::string& setting : settings_between(ventricle::preset(run.preset), options))
    command += " --set " + setting;
  if (!run.study->series.empty()) command += " --series " + run.study->series;
  return command;
}

}  // namespace

std::vector<io::MeshFormat> formats_from(const std::vector<std::string>& words) {
  std::vector<io::MeshFormat> formats;
  for (const std::string& word : words)
    formats.push_back(static_cast<io::MeshFormat>(position_of(io::names_of(io::MeshFormat{}), word, "mesh_formats")));
  return formats;
}

std::shared_ptr<Heart> reconstruct_heart(const HeartRun& run, const Progress& progress) {
  auto heart = std::make_shared<Heart>();
  heart->options = run.options;
  heart->provenance.program_version = app::version();
  heart->provenance.commit = app::commit();
  heart->provenance.command = command_of(run);
  heart->provenance.inputs = run.study->inputs;
  heart->provenance.options_json = io::options_to_text(run.options);
  heart->study = run.study;
  heart->mask_sha256 = run.mask_sha256;
  heart->start_sha256 = run.start_sha256;
  ventricle::Additions additions{.start = run.start.get(), .mask = run.mask.get(), .stages = run.own};
  std::unique_lock<std::mutex> alone;
  if (run.cache) {
    alone = std::unique_lock(run.cache->in_use);
    additions.cache = &run.cache->ventricle;
  }
  heart->result = ventricle::reconstruct(*run.study, run.options, progress, additions);
  return heart;
}

void save_heart(const Heart& heart, const std::filesystem::path& out, const HeartOutputs& outputs) {
  report::check_labels(outputs.labels, "labels");
  report::VentricleRecord record;
  record.mask_sha256 = heart.mask_sha256;
  record.start_mesh_sha256 = heart.start_sha256;
  record.mesh_formats = formats_from(outputs.mesh_formats);
  record.labels = outputs.labels;
  record.timings = outputs.timings ? report::Timings::keep : report::Timings::omit;
  io::OutputFolder folder(out, outputs.replace ? io::Existing::move_aside : io::Existing::replace);
  report::write_study_files(heart.result, heart.provenance,
                            {record.mesh_formats, heart.options.keyframes, report::Timings::omit,
                             report::ventricle_results_text(heart.result, heart.provenance, record)},
                            folder.path());
  if (!outputs.labels.ending.empty())
    report::write_label_volumes(heart.result, *heart.study, outputs.labels, folder.path() / "labels");
  folder.publish();
}

}  // namespace dynasurf::python
