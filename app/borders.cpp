#include <memory>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "borders_matrix.hpp"
#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"

namespace dynasurf::app {
namespace {

/// What was found of one gate, for programs.
ExitCode print_json(const BordersArguments& arguments, std::stop_token stop) {
  if (!arguments.out.path.empty()) throw OptionError("--json writes no files; expected no --out beside it");
  if (arguments.edges_only) throw OptionError("--json and --edges-only were given; expected one of them");
  if (!arguments.vary.empty()) throw OptionError("--json and --vary were given; expected one of them");
  std::optional<Image> mask;
  if (!arguments.options.mask.empty()) mask = read_mask(arguments.options.mask);
  const Study study = io::read_study(arguments.study, arguments.series);
  const int gate = gate_of(arguments, study) - 1;
  std::optional<heart::Location> located;
  if (!arguments.located.empty()) located = report::read_location(arguments.located);
  const ventricle::BorderResult result =
      ventricle::find_borders(study, options_of(arguments.options), {{}, stop},
                              {.mask = mask ? &*mask : nullptr, .only_gate = gate, .located = located});
  print(report::borders_json(result, gate));
  return done;
}

ExitCode run(const BordersArguments& arguments, std::stop_token stop) {
  const ThreadLimit limit(arguments.threads);
  if (arguments.json) return print_json(arguments, stop);
  if (!arguments.located.empty()) throw OptionError("--located was given without --json; expected both");
  if (arguments.out.path.empty()) throw OptionError("--out is required, unless --json is given");
  return draw_borders(arguments, stop);
}

}  // namespace

int gate_of(const BordersArguments& arguments, const Study& study) {
  const int gates = study.gates.size();
  if (arguments.gate > gates)
    throw OptionError("--gate " + std::to_string(arguments.gate) + ": the study has " + std::to_string(gates));
  return arguments.gate;
}

void add_borders(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<BordersArguments>();
  CommandLine command(program, "borders",
                      "Find the edges and label the borders of every gate, and draw both as PNG sheets");
  command.option("STUDY", a->study, "DICOM file or folder, NIfTI or NRRD file").required();
  add_series_argument(command, a->series);
  add_out_folder(command, a->out, "folder for the sheets");
  add_option_arguments(command, a->options);
  command
      .option("--vary", a->vary,
              "path=value,value,...: one slice under all these values in matrix.png instead of the sheets; "
              "given twice, columns by the first and rows by the second")
      .repeated();
  command.option("--gate", a->gate, "of --vary and --json: the gate, from 1; it is looked at alone").within(1, 1000);
  command.option("--slice", a->slice, "of --vary: the slice, from 1 at the apex (the middle of the cavity)")
      .within(1, 10000);
  command.flag("--edges-only", a->edges_only, "find and draw the edges alone");
  command.flag("--json", a->json,
               "print the voxels of edges and borders of one gate, and the fields around its borders, in place of the "
               "sheets; bytes are deflated, in base64");
  command.option("--located", a->located,
                 "with --json: what it printed before of the same study, mask, excluded gates and heart by hand; the "
                 "heart is not looked for again");
  command.option("--threads", a->threads, "threads at most; the result is the same (0: all)").within(0, 1024);
  command.flag("--quiet", a->quiet, "print nothing");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
