#include "reconstruction.hpp"

#include <optional>

#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/report/detail/run_record.hpp"
#include "dynasurf/report/detail/stages.hpp"
#include "dynasurf/report/result_folders.hpp"

#include "kept_stages.hpp"
#include "live_page.hpp"
#include "option_arguments.hpp"
#include "print_page.hpp"
#include "reconstruction_dicom.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

/// What is made from the finished report and result: the printed pages, and the DICOM objects, which hold them.
void write_for_reading_room(const ventricle::Result& result, const report::Provenance& provenance, const Job& job,
                            const fs::path& folder, const std::stop_token& stop) {
  if (job.outputs.pdf) print_page(folder / "report.html", folder / "report.pdf", stop);
  if (!job.outputs.dicom) return;
  report::write_dicom_folder(result, dicom_context(job, provenance, result.study.format == "DICOM"),
                             job.outputs.pdf ? io::text_of_file(folder / "report.pdf") : std::string(),
                             folder / "dicom");
}

std::string results_text(const ventricle::Result& result, const report::Provenance& provenance, const Job& job) {
  const Outputs& outputs = job.outputs;
  report::VentricleRecord record;
  record.mask_sha256 = hash_of(job.mask);
  record.start_mesh_sha256 = hash_of(job.start_mesh);
  record.mesh_formats = job.mesh_formats;
  record.keep_stages = outputs.keep_stages;
  record.dicom = outputs.dicom;
  record.pdf = outputs.pdf;
  record.labels = outputs.labels;
  // Without timings it is the study's, which a repeated run reads there again.
  if (outputs.dicom && job.timings) record.dicom_time = outputs.dicom_time;
  record.timings = job.timings ? report::Timings::keep : report::Timings::omit;
  return report::ventricle_results_text(result, provenance, record);
}

/// Every file the run reads.
std::vector<fs::path> inputs_of(const Job& job) {
  std::vector<fs::path> inputs{job.study};
  for (const fs::path& given : {job.mask, job.start_mesh, job.options_file})
    if (!given.empty()) inputs.push_back(given);
  return inputs;
}

/// What the page needs to run the study again.
std::vector<fs::path> inputs_for_page(const Job& job) {
  std::vector<fs::path> files = io::files_of_study(job.study, job.series);
  if (!job.mask.empty()) files.push_back(job.mask);
  return files;
}

}  // namespace

std::vector<std::string> hashes_of_study(const fs::path& study, const std::string& series) {
  std::vector<std::string> hashes;
  for (const fs::path& file : io::files_of_study(study, series)) hashes.push_back(io::sha256_of_file(file));
  return hashes;
}

Outcome reconstruct_to_folder(const Job& asked, const Progress& progress) {
  Job job = asked;
  const ThreadLimit limit(job.threads);
  if (job.outputs.pdf) find_browser();  // its absence, too, is told first
  report::check_labels(job.outputs.labels, "--labels");
  // First, so that a place that cannot be written to costs no time.
  io::OutputFolder folder(job.out, job.existing, inputs_of(job));
  std::optional<TraceStage> noted(std::in_place, "read");
  const Study study = io::read_study(job.study, job.series);
  // By its number: words that the user chose it by may name a person. A repeated run has them from the first.
  if (!study.series.empty() && job.command.find(" --series ") == std::string::npos)
    job.command += " --series " + study.series;
  if (job.outputs.dicom) job.outputs.dicom_time = dicom_time(job, study.format == "DICOM");
  const report::Provenance provenance =
      provenance_of(job, io::files_of_study(job.study, job.series), io::options_to_text(job.options));
  progress.check();

  std::optional<TriMesh> start;
  if (!job.start_mesh.empty()) start = io::read_mesh(job.start_mesh);
  std::optional<Image> mask;
  if (!job.mask.empty()) mask = read_mask(job.mask);
  noted.reset();

  const report::StageWriter stages(folder.path() / "stages");
  Outcome outcome;
  const ventricle::IntermediateSink keep =
      job.outputs.keep_stages ? ventricle::IntermediateSink([&](const ventricle::Intermediates& s) { stages(s); })
                              : ventricle::IntermediateSink();
  try {
    outcome.result = ventricle::reconstruct(study, job.options, progress,
                                            {.keep = keep,
                                             .start = start ? &*start : nullptr,
                                             .mask = mask ? &*mask : nullptr,
                                             .cache = kept_stages(study)});
  } catch (const InputError& error) {  // the library knows the study, not the file it came from
    throw InputError(job.study.string() + ": " + error.what());
  }
  if (job.outputs.keep_stages && outcome.result.readings.psf_corrected)
    stages.write_fit(outcome.result.readings.psf_corrected->images);
  progress.check();
  noted.emplace("write");
  outcome.json = results_text(outcome.result, provenance, job);
  report::write_study_files(outcome.result, provenance,
                            {job.mesh_formats, job.options.keyframes, report::Timings::omit, outcome.json},
                            folder.path());
  if (!job.outputs.labels.ending.empty())
    report::write_label_volumes(outcome.result, study, job.outputs.labels, folder.path() / "labels");
  write_for_reading_room(outcome.result, provenance, job, folder.path(), progress.stop);
  if (!job.live_page.empty()) write_live_page(job.live_page, inputs_for_page(job), folder.path());
  progress.check();
  noted.emplace("publish");
  folder.publish();
  outcome.moved_to = folder.moved_to();
  return outcome;
}

}  // namespace dynasurf::app
