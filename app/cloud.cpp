#include <memory>

#include "dynasurf/core/option_tree.hpp"

#include "cloud_run.hpp"
#include "command.hpp"
#include "command_line.hpp"
#include "option_arguments.hpp"

namespace dynasurf::app {
namespace {

struct CloudArguments {
  std::vector<std::string> clouds;
  ResultArguments result;
  std::string preset = "shaped", file;
  std::string triangles, max_error, genus, start, boundary, lid;
  bool keep_sharp = false;
  std::vector<std::string> settings;
  bool textures = false, packed = false, strict = false;
};

/// "0.1%" or "0.1": percent of the diagonal either way.
std::string without_percent(std::string text) {
  if (!text.empty() && text.back() == '%') text.pop_back();
  return text;
}

/// The short arguments stand as settings of options, so that they are checked, recorded and repeated like every other.
std::vector<std::string> settings_of(const CloudArguments& a) {
  std::vector<std::string> settings;
  if (!a.triangles.empty()) settings.push_back("triangles=" + a.triangles);
  if (!a.max_error.empty()) settings.push_back("max_error_percent=" + without_percent(a.max_error));
  if (!a.genus.empty()) settings.push_back("genus=" + a.genus);
  if (!a.start.empty()) settings.push_back("start=" + a.start);
  if (!a.boundary.empty()) settings.push_back("boundary=" + a.boundary);
  if (!a.lid.empty()) settings.push_back("lid=" + a.lid);
  if (a.keep_sharp) settings.emplace_back("keep_sharp=true");
  settings.insert(settings.end(), a.settings.begin(), a.settings.end());
  return settings;
}

cloud::Options options_of(const CloudArguments& a) {
  cloud::Options options = cloud::preset(a.preset);
  if (!a.file.empty()) read_options(a.file, nodes_of(options));
  set_options(options, settings_of(a));
  cloud::check(options);  // refused before any work is done
  return options;
}

/// The command line without paths, which may name a person, and without what leaves the result as it is.
std::string recorded_command(const CloudArguments& a) {
  std::string command = "dynasurf cloud";
  for (std::size_t n = 0; n < a.clouds.size(); ++n) command += " CLOUD";
  command += " --out RESULT --preset " + a.preset;
  if (!a.file.empty()) command += " --options FILE";
  for (const std::string& setting : settings_of(a)) command += " --set " + shell_word(setting);
  return command;
}

ExitCode run(const CloudArguments& arguments, std::stop_token stop) {
  CloudJob job;
  take(arguments.result, recorded_command(arguments), job);
  job.clouds.assign(arguments.clouds.begin(), arguments.clouds.end());
  job.options = options_of(arguments);
  job.options_file = arguments.file;
  job.textures = arguments.textures;
  job.packed = arguments.packed;
  CloudOutcome outcome;
  run_with_trace(arguments.result, stop,
                 [&](const Progress& progress) { outcome = reconstruct_cloud_to_folder(job, progress); });
  print_result(arguments.result, outcome.json, summary_of(outcome.run), outcome.moved_to);
  const cloud::Verdict verdict = cloud::verdict_of(outcome.run.result);
  return verdict == cloud::Verdict::fail || (arguments.strict && verdict != cloud::Verdict::ok) ? not_trustworthy
                                                                                                : done;
}

}  // namespace

void add_cloud(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<CloudArguments>();
  CommandLine command(program, "cloud", "Light meshes, closed or open, from scanned points");
  command
      .option(
          "CLOUD", a->clouds,
          "PLY, XYZ, PTS, CSV, PWN, OBJ, OFF, LAS, LAZ, PCD, PTX, E57 file of points, or a surface as STL, PLY, OBJ, "
          "OFF; several files are one cloud")
      .required();
  add_result_arguments(command, a->result, "ply");
  add_live_argument(command, a->result);
  add_trace_argument(command, a->result);
  command.option("--preset", a->preset,
                 "shaped: well-shaped triangles; faithful: smallest distance; thesis: as published");
  command.option("--options", a->file, "JSON file of options, such as the options.json of a result");
  command.option("--triangles", a->triangles, "triangles of each level: 5120,1280,320");
  command.option("--max-error", a->max_error,
                 "instead: fewest triangles whose mean distance is below this, percent of the diagonal: 0.1%");
  command.option("--genus", a->genus, "handles: auto, 0 or keep");
  command.option("--start", a->start, "mesh that is deformed: auto, field, sphere, ellipsoid or hull");
  command.option("--boundary", a->boundary, "where the points end: auto, close, keep (an open surface) or trim");
  command.option("--lid", a->lid, "what closes a hole: smooth or flat");
  command.flag("--keep-sharp", a->keep_sharp, "do not smooth across sharp edges");
  command.option("--set", a->settings, "set one option: path=value; may be repeated (see: dynasurf options cloud)")
      .repeated();
  command.flag("--strict", a->strict, "end with exit code 3 for the verdict check too, not for fail alone");
  command.flag("--textures", a->textures,
               "write textured.glb too: all levels with normal maps, and colour maps where the points have colours");
  command.flag("--packed", a->packed,
               "write packed.glb too: all levels in a quarter of the bytes, for viewers that know meshopt");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
