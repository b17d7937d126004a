#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/report/provenance.hpp"

#include "command_line.hpp"
#include "out_argument.hpp"

namespace dynasurf::app {

/// What every run that leaves a result folder shares, whatever it makes.
struct ResultJob {
  std::filesystem::path out;
  io::Existing existing = io::Existing::replace;  // at `out`
  std::filesystem::path options_file;             // read before the run; empty: none
  std::vector<io::MeshFormat> mesh_formats;
  bool timings = true;                      // in results.json
  std::string command;                      // for the provenance
  bool file_names = false;                  // record the names of the input files, which may name a person
  std::vector<std::string> recorded_names;  // of the input files, when an earlier run gave them
  int threads = 0;                          // 0: as many as the machine has
  std::filesystem::path live_page;          // dynasurf.html, of which live.html is made; empty: none is asked for
};

/// The arguments that become a ResultJob, and how the run speaks.
struct ResultArguments {
  OutFolder out;
  std::vector<std::string> mesh_formats;
  bool quiet = false, json = false, no_timings = false, with_names = false, live = false;
  int threads = 0;
  std::string trace;
};

/// `formats` are those that are written when none are asked for.
void add_result_arguments(CommandLine& command, ResultArguments& arguments, const std::string& formats);

/// --live, of the commands whose inputs dynasurf.html reads.
void add_live_argument(CommandLine& command, ResultArguments& arguments);

/// --trace, of the commands that run_with_trace.
void add_trace_argument(CommandLine& command, ResultArguments& arguments);

/// Formats by their words, each once. `where` stands in the OptionError for a word that is none.
std::vector<io::MeshFormat> mesh_formats_of(const std::vector<std::string>& words, const std::string& where);
/// The words of --mesh-format for a help text: "ply, stl, ...".
std::string mesh_format_choices();

/// Sets what the user asked for; the rest of `job` stays.
void take(const ResultArguments& arguments, const std::string& command, ResultJob& job);

/// Program, command, options, and the name and hash of every input.
report::Provenance provenance_of(const ResultJob& job, const std::vector<std::filesystem::path>& inputs,
                                 std::string options_json);

/// Runs `work` while telling its stages on standard error, unless --quiet.
void run_with_progress(bool quiet, const std::stop_token& stop, const std::function<void(const Progress&)>& work);

/// The same, and writes the trace where one is asked for.
void run_with_trace(const ResultArguments& arguments, const std::stop_token& stop,
                    const std::function<void(const Progress&)>& work);

/// What a run prints when it has ended: with --json its results.json; else the table and the place, or with --quiet
/// nothing.
/// `moved_to` is where --replace moved what stood at --out.
void print_result(const ResultArguments& arguments, const std::string& json, const std::string& summary,
                  const std::optional<std::filesystem::path>& moved_to = {});

}  // namespace dynasurf::app
