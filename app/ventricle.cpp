#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"

#include "command.hpp"
#include "console.hpp"
#include "option_arguments.hpp"
#include "reconstruction.hpp"

namespace dynasurf::app {
namespace {

struct Arguments {
  std::string study, out, start;
  OptionArguments options;
  std::vector<std::string> mesh_formats;
  bool keep_stages = false, quiet = false, json = false, with_phi = false, no_timings = false, dicom = false,
       pdf = false;
  int threads = 0;
};

std::vector<MeshFormat> formats_of(const Arguments& arguments) {
  std::vector<MeshFormat> formats;
  for (const std::string& word : arguments.mesh_formats) {
    const auto format = static_cast<MeshFormat>(position_of(names_of(MeshFormat{}), word, "--mesh-format"));
    if (std::find(formats.begin(), formats.end(), format) == formats.end()) formats.push_back(format);
  }
  return formats;
}

/// The command line without paths, which may name a person, and without what leaves the result as it is.
std::string recorded_command(const Arguments& arguments) {
  std::string command = "dynasurf ventricle STUDY --out RESULT --preset " + arguments.options.preset;
  if (!arguments.options.file.empty()) command += " --options FILE";
  if (!arguments.start.empty()) command += " --start MESH";
  if (!arguments.options.mask.empty()) command += " --mask MASK";
  for (const std::string& setting : settings_of(arguments.options)) command += " --set " + setting;
  return command;
}

ExitCode run(const Arguments& arguments, std::stop_token stop) {
  Job job;
  job.study = arguments.study;
  job.out = arguments.out;
  job.options = options_of(arguments.options);
  job.mask = arguments.options.mask;
  if (!arguments.start.empty()) {
    job.start_mesh = arguments.start;
    job.options.placement.shape = StartShape::file;
  }
  if (!arguments.mesh_formats.empty()) job.outputs.mesh_formats = formats_of(arguments);
  job.outputs.keep_stages = arguments.keep_stages;
  job.outputs.dicom = arguments.dicom;
  job.outputs.pdf = arguments.pdf;
  job.outputs.timings = !arguments.no_timings;
  job.command = recorded_command(arguments);
  job.file_names = arguments.with_phi;
  job.threads = arguments.threads;

  ProgressLine line(arguments.quiet);
  const Progress progress{[&](std::string_view stage, int done, int total) { line(stage, done, total); }, stop};
  const Outcome outcome = reconstruct_to_folder(job, progress);
  line.finish();
  if (arguments.json)
    print(outcome.json);
  else if (!arguments.quiet)
    print(summary_of(outcome.result) + "result: " + arguments.out + "\n");
  return outcome.result.verdict == Verdict::fail ? not_trustworthy : done;
}

}  // namespace

void add_ventricle(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand(
      "ventricle", "Reconstruct both surfaces of the left ventricle in every gate, with volumes and a report");
  command->add_option("STUDY", a->study, "DICOM file or folder, NIfTI or NRRD file")->required();
  command->add_option("--out", a->out, "folder of the result; a former result there is replaced")->required();
  add_option_arguments(*command, a->options);
  command->add_option("--start", a->start, "mesh file that all surfaces start from, fitted to each border's box");
  command->add_option("--mesh-format", a->mesh_formats, "ply,stl,obj,off,vtp: one or more (ply,vtp)")->delimiter(',');
  command->add_flag("--keep-stages", a->keep_stages, "write every intermediate step to RESULT/stages");
  command->add_flag("--pdf", a->pdf, "print the report to report.pdf, two A4 pages (needs Chromium)");
  command->add_flag("--dicom", a->dicom,
                    "write RESULT/dicom with the patient's name and id of the study: measurements (SR), segmentations, "
                    "surfaces, with --pdf the report");
  command->add_option("--threads", a->threads, "threads at most; the result is the same (0: all)")
      ->check(CLI::Range(0, 1024));
  command->add_flag("--quiet", a->quiet, "print nothing but what --json asks for");
  command->add_flag("--json", a->json, "print results.json instead of the table");
  command->add_flag("--no-timings", a->no_timings, "leave the times out, so that equal runs give equal bytes");
  command->add_flag("--with-phi", a->with_phi, "record the names of the input files, which may name a person");
  command->callback([a, &chosen] { chosen = [a](std::stop_token stop) { return run(*a, stop); }; });
}

}  // namespace dynasurf::app
