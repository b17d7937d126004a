#include <memory>

#include "command.hpp"
#include "command_line.hpp"
#include "label_arguments.hpp"
#include "option_arguments.hpp"
#include "reconstruction.hpp"
#include "summary.hpp"

namespace dynasurf::app {
namespace {

struct VentricleArguments {
  std::string study, series, start;
  ResultArguments result;
  OptionArguments options;
  report::LabelOutput labels;
  bool keep_stages = false, dicom = false, pdf = false, strict = false;
};

/// The command line without paths, which may name a person, and without what leaves the result as it is.
std::string recorded_command(const VentricleArguments& arguments) {
  std::string command = "dynasurf ventricle STUDY --out RESULT --preset " + arguments.options.preset;
  if (!arguments.options.file.empty()) command += " --options FILE";
  if (!arguments.start.empty()) command += " --start MESH";
  if (!arguments.options.mask.empty()) command += " --mask MASK";
  for (const std::string& setting : settings_of(arguments.options)) command += " --set " + shell_word(setting);
  return command;
}

ExitCode run(const VentricleArguments& arguments, std::stop_token stop) {
  Job job;
  take(arguments.result, recorded_command(arguments), job);
  job.study = arguments.study;
  job.series = arguments.series;
  job.options = options_of(arguments.options);
  job.options_file = arguments.options.file;
  job.mask = arguments.options.mask;
  if (!arguments.start.empty()) {
    job.start_mesh = arguments.start;
    job.options.placement.shape = mesh::StartShape::file;
  }
  job.outputs = {arguments.keep_stages, arguments.dicom, "", arguments.pdf, arguments.labels};
  Outcome outcome;
  run_with_trace(arguments.result, stop,
                 [&](const Progress& progress) { outcome = reconstruct_to_folder(job, progress); });
  print_result(arguments.result, outcome.json, summary_of(outcome.result), outcome.moved_to);
  const ventricle::Verdict verdict = outcome.result.verdict;
  return verdict == ventricle::Verdict::fail || (arguments.strict && verdict != ventricle::Verdict::ok)
             ? not_trustworthy
             : done;
}

}  // namespace

void add_ventricle(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<VentricleArguments>();
  CommandLine command(program, "ventricle",
                      "Reconstruct both surfaces of the left ventricle in every gate, with volumes and a report");
  command.option("STUDY", a->study, "DICOM file or folder, NIfTI or NRRD file").required();
  add_series_argument(command, a->series);
  add_result_arguments(command, a->result, "ply, vtp");
  add_live_argument(command, a->result);
  add_trace_argument(command, a->result);
  add_option_arguments(command, a->options);
  command.option("--start", a->start, "mesh file that all surfaces start from, fitted to each border's box");
  command.flag("--keep-stages", a->keep_stages, "write every intermediate step to RESULT/stages");
  add_label_arguments(command, a->labels);
  command.flag("--strict", a->strict, "end with exit code 3 for the verdict check too, not for fail alone");
  command.flag("--pdf", a->pdf, "print the report to report.pdf, two A4 pages (needs Chromium)");
  command.flag("--dicom", a->dicom,
               "write RESULT/dicom with the patient's name and id of the study: measurements (SR), segmentations, "
               "surfaces, with --pdf the report");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
