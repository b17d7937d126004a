#include "result_job.hpp"

#include <algorithm>

#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/report/detail/run_record.hpp"

#include "console.hpp"
#include "live_page.hpp"
#include "utf8.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

/// The folder of a result appears as a whole, with nothing of others in it.
void refuse_within(const std::filesystem::path& out, const std::filesystem::path& trace) {
  const auto whole = [](const std::filesystem::path& path) {
    // Weakly: neither place need be there yet.
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path));
  };
  const std::filesystem::path within = whole(trace).lexically_relative(whole(out));
  if (!within.empty() && *within.begin() != "..")
    throw OptionError("--trace " + trace.string() + ": lies in --out " + out.string() + "; expected a place beside it");
}

}  // namespace

void add_result_arguments(CommandLine& command, ResultArguments& a, const std::string& formats) {
  add_out_folder(command, a.out, "folder of the result").required();
  command
      .option("--mesh-format", a.mesh_formats,
              mesh_format_choices() + ": one or more, with commas between them (" + formats + ")")
      .list();
  command.option("--threads", a.threads, "threads at most; the result is the same (0: all)").within(0, 1024);
  command.flag("--quiet", a.quiet, "print nothing but what --json asks for");
  command.flag("--json", a.json, "print results.json instead of the table");
  command.flag("--no-timings", a.no_timings, "leave the times out, so that equal runs give equal bytes");
  command.flag("--with-names,--with-phi", a.with_names, "record the names of the input files, which may name a person");
}

void add_live_argument(CommandLine& command, ResultArguments& a) {
  command.flag("--live", a.live,
               "write live.html too: dynasurf.html with the input, as it is, names too, and the result inside");
}

void add_trace_argument(CommandLine& command, ResultArguments& a) {
  command.option(
      "--trace", a.trace,
      "write which thread did what and when to this file, as events for ui.perfetto.dev and chrome://tracing");
}

std::vector<io::MeshFormat> mesh_formats_of(const std::vector<std::string>& words, const std::string& where) {
  std::vector<io::MeshFormat> formats;
  for (const std::string& word : words) {
    const auto format = static_cast<io::MeshFormat>(position_of(io::names_of(io::MeshFormat{}), word, where));
    if (std::find(formats.begin(), formats.end(), format) == formats.end()) formats.push_back(format);
  }
  return formats;
}

std::string mesh_format_choices() {
  std::string text;
  for (const std::string_view word : io::names_of(io::MeshFormat{}))
    text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

void take(const ResultArguments& arguments, const std::string& command, ResultJob& job) {
  job.out = arguments.out.path;
  job.existing = arguments.out.existing();
  if (!arguments.mesh_formats.empty()) job.mesh_formats = mesh_formats_of(arguments.mesh_formats, "--mesh-format");
  job.timings = !arguments.no_timings;
  job.command = command;
  job.file_names = arguments.with_names;
  job.threads = arguments.threads;
  if (arguments.live) job.live_page = installed_page();
}

report::Provenance provenance_of(const ResultJob& job, const std::vector<std::filesystem::path>& inputs,
                                 std::string options_json) {
  report::Provenance provenance;
  provenance.program_version = version();
  provenance.commit = commit();
  provenance.command = job.command;
  provenance.options_json = std::move(options_json);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string name = i < job.recorded_names.size() ? job.recorded_names[i]
                             : job.file_names              ? valid_utf8(inputs[i].filename().string())
                                                           : report::neutral_name(inputs[i], i);
    provenance.inputs.push_back({name, io::sha256_of_file(inputs[i]), std::filesystem::file_size(inputs[i])});
  }
  return provenance;
}

void run_with_progress(bool quiet, const std::stop_token& stop, const std::function<void(const Progress&)>& work) {
  ProgressLine line(quiet);
  work({[&](std::string_view stage, int done, int total) { line(stage, done, total); }, stop});
}

void run_with_trace(const ResultArguments& arguments, const std::stop_token& stop,
                    const std::function<void(const Progress&)>& work) {
  if (arguments.trace.empty()) return run_with_progress(arguments.quiet, stop, work);
  refuse_within(arguments.out.path, arguments.trace);
  const io::Existing existing = arguments.out.replace ? io::Existing::move_aside : io::Existing::refuse;
  io::OutputFile file(arguments.trace, existing);  // first: a place that cannot be written to costs no time
  const Trace trace;
  run_with_progress(arguments.quiet, stop, work);
  io::write_file(file.path(), trace.json());
  file.publish();
}

void print_result(const ResultArguments& arguments, const std::string& json, const std::string& summary,
                  const std::optional<std::filesystem::path>& moved_to) {
  if (arguments.json)
    print(json);
  else if (!arguments.quiet)
    print(summary + "result: " + arguments.out.path + "\n" +
          (moved_to ? "moved aside: " + moved_to->string() + "\n" : std::string()));
}

}  // namespace dynasurf::app
