#include <algorithm>
#include <array>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>

#include <CLI/CLI.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/ventricle/presets.hpp"

#include "command.hpp"
#include "console.hpp"
#include "reconstruction.hpp"

namespace dynasurf::app {
namespace {

struct Arguments {
  std::string study, out, start, pipeline, preset = "default", options_file;
  std::vector<std::string> settings, mesh_formats;
  bool keep_stages = false, quiet = false, json = false, with_phi = false, no_timings = false;
  int threads = 0;
  // What a person says in place of what would be found.
  std::vector<double> center, axis;
  std::optional<double> radius_mm, base_plane_mm;
  std::optional<int> first_slice, last_slice;
};

/// The same as settings of `manual`, so that they are checked, recorded and repeated like every other option.
std::vector<std::string> manual_settings(const Arguments& a) {
  std::vector<std::string> settings;
  const auto set = [&](const std::string& name, double value) {
    std::ostringstream text;
    text << "manual." << name << '=' << std::setprecision(12) << value;
    settings.push_back(text.str());
  };
  const std::array<std::string, 3> letters{"x", "y", "z"};
  for (std::size_t n = 0; n < a.center.size(); ++n) set("center_" + letters.at(n) + "_mm", a.center[n]);
  for (std::size_t n = 0; n < a.axis.size(); ++n) set("axis_" + letters.at(n), a.axis[n]);
  if (a.radius_mm) set("radius_mm", *a.radius_mm);
  if (a.first_slice) set("first_slice", *a.first_slice);
  if (a.last_slice) set("last_slice", *a.last_slice);
  if (a.base_plane_mm) set("base_plane_mm", *a.base_plane_mm);
  return settings;
}

std::string text_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  if (!file.good() && !file.eof()) throw IoError(path + ": cannot be read");
  if (text.empty()) throw IoError(path + ": expected a JSON file of options, and it is missing or empty");
  return text;
}

/// Defaults < preset < file < --pipeline < --set.
VentricleOptions options_of(const Arguments& arguments) {
  VentricleOptions options = ventricle_preset(arguments.preset);
  if (!arguments.options_file.empty()) {
    const std::string text = text_of_file(arguments.options_file);
    try {
      options_from_text(text, options);
    } catch (const OptionError& error) {
      throw OptionError(arguments.options_file + ": " + error.what());
    }
  }
  if (!arguments.pipeline.empty()) set_option(options, "pipeline=" + arguments.pipeline);
  for (const std::string& setting : arguments.settings) set_option(options, setting);
  return options;
}

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
  std::string command = "dynasurf ventricle STUDY --out RESULT --preset " + arguments.preset;
  if (!arguments.options_file.empty()) command += " --options FILE";
  if (!arguments.pipeline.empty()) command += " --pipeline " + arguments.pipeline;
  if (!arguments.start.empty()) command += " --start MESH";
  for (const std::string& setting : arguments.settings) command += " --set " + setting;
  return command;
}

ExitCode run(Arguments arguments, std::stop_token stop) {
  const std::vector<std::string> by_hand = manual_settings(arguments);
  arguments.settings.insert(arguments.settings.end(), by_hand.begin(), by_hand.end());
  Job job;
  job.study = arguments.study;
  job.out = arguments.out;
  job.options = options_of(arguments);
  if (!arguments.start.empty()) {
    job.start_mesh = arguments.start;
    job.options.placement.shape = StartShape::file;
  }
  if (!arguments.mesh_formats.empty()) job.outputs.mesh_formats = formats_of(arguments);
  job.outputs.keep_stages = arguments.keep_stages;
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
  else
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
  command->add_option("--preset", a->preset, "default, or thesis: as published");
  command->add_option("--pipeline", a->pipeline,
                      "surface; contour: a contour in every slice; direct: one field straight from the image");
  command->add_option("--start", a->start, "mesh file that all surfaces start from, fitted to each border's box");
  command->add_option("--options", a->options_file, "JSON file of options, such as the options.json of a result");
  command->add_option("--set", a->settings, "set one option: path=value; may be repeated (see: dynasurf options)")
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--center", a->center, "by hand: middle of the heart x,y,z in the world (LPS), mm")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--axis", a->axis, "by hand: long axis x,y,z from apex to base in the world (LPS)")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--radius", a->radius_mm, "by hand: circle around the ventricle, mm");
  command->add_option("--first-slice", a->first_slice, "by hand: first slice of the ventricle, from 1 at the apex");
  command->add_option("--last-slice", a->last_slice, "by hand: its last slice");
  command->add_option("--base-plane", a->base_plane_mm, "by hand: height of the valve plane over slice 1, mm");
  command->add_option("--mesh-format", a->mesh_formats, "ply,stl,obj,off,vtp: one or more (ply,vtp)")->delimiter(',');
  command->add_flag("--keep-stages", a->keep_stages, "write every intermediate step to RESULT/stages");
  command->add_option("--threads", a->threads, "threads at most; the result is the same (0: all)")
      ->check(CLI::Range(0, 1024));
  command->add_flag("--quiet", a->quiet, "no progress on standard error");
  command->add_flag("--json", a->json, "print results.json instead of the table");
  command->add_flag("--no-timings", a->no_timings, "leave the times out, so that equal runs give equal bytes");
  command->add_flag("--with-phi", a->with_phi, "record the names of the input files, which may name a person");
  command->callback([a, &chosen] { chosen = [a](std::stop_token stop) { return run(*a, stop); }; });
}

}  // namespace dynasurf::app
