#include <algorithm>
#include <memory>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/options_json.hpp"

#include "cloud_run.hpp"
#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "reconstruction.hpp"
#include "rerun_parts.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

/// What was written beside numbers and meshes, to be looked at.
io::JsonNode outputs_of(const RerunArguments& arguments, const RerunRecord& record) {
  return {&record.outputs, (fs::path(arguments.result) / "results.json").string(), "provenance.outputs"};
}

/// What every kind of run needs to be repeated.
void recall(const RerunArguments& arguments, const RerunRecord& record, const fs::path& out, ResultJob& job) {
  job.out = out;
  job.existing = arguments.out.existing();
  job.options_file = fs::path(arguments.result) / "results.json";
  job.mesh_formats = mesh_formats_of(words_in(outputs_of(arguments, record), "mesh_formats"), "outputs.mesh_formats");
  job.timings = record.timings;
  job.command = record.command;
  job.recorded_names = record.names;
  job.threads = arguments.threads;
}

/// Calls `read`, which turns what was recorded into a job, and blames the record for what it does not understand.
template <class Read>
auto read_record(const fs::path& result, const Read& read) {
  try {
    return read();
  } catch (const OptionError& error) {
    refuse_record(result, error.what());
  }
}

/// Repeats the run into `out`; tells whether its result may be trusted.
bool repeat_ventricle(const RerunArguments& arguments, const RerunRecord& record, const fs::path& out,
                      const Progress& progress) {
  Job job = read_record(arguments.result, [&] {
    Job read;
    io::options_from_json(record.options, read.options);
    recall(arguments, record, out, read);
    const io::JsonNode outputs = outputs_of(arguments, record);
    read.outputs.keep_stages = io::flag_in(outputs, "keep_stages");
    // Results of former versions say nothing of these.
    read.outputs.dicom = io::has(outputs, "dicom") && io::flag_in(outputs, "dicom");
    if (read.outputs.dicom && record.timings)  // else the study tells it
      read.outputs.dicom_time = dicom_time_in(outputs);
    read.outputs.pdf = io::has(outputs, "pdf") && io::flag_in(outputs, "pdf");
    if (io::has(outputs, "labels"))
      read.outputs.labels = {io::text_in(outputs, "labels"), io::flag_in(outputs, "partial_volumes")};
    report::check_labels(read.outputs.labels, "outputs.labels");
    return read;
  });
  job.study = find_study(arguments, record);
  job.series = record.series;
  job.mask = find_given(arguments, record.mask_hash, arguments.mask, "mask");
  job.start_mesh = find_given(arguments, record.start_hash, arguments.start, "start");
  return reconstruct_to_folder(job, progress).result.verdict != ventricle::Verdict::fail;
}

bool repeat_cloud(const RerunArguments& arguments, const RerunRecord& record, const fs::path& out,
                  const Progress& progress) {
  CloudJob job = read_record(arguments.result, [&] {
    CloudJob read;
    io::options_from_json(record.options, read.options);
    recall(arguments, record, out, read);
    const io::JsonNode outputs = outputs_of(arguments, record);
    read.textures = io::flag_in(outputs, "textures");
    read.packed = io::has(outputs, "packed") && io::flag_in(outputs, "packed");  // told where it was asked for
    return read;
  });
  job.clouds = find_clouds(arguments, record);
  return report::is_trustworthy(reconstruct_cloud_to_folder(job, progress).run.result);
}

ExitCode run(const RerunArguments& arguments, std::stop_token stop) {
  const RerunRecord record = rerun_record_of(arguments.result);
  // A folder beside the result that is never published, and so goes away again.
  const fs::path result = fs::weakly_canonical(arguments.result);
  const io::OutputFolder scratch(result.parent_path() / (result.filename().string() + ".rerun"),
                                 io::Existing::move_aside);
  const fs::path out = arguments.out.is_asked() ? fs::path(arguments.out.path) : scratch.path() / "again";

  bool trusted = false;
  run_with_progress(arguments.quiet, stop, [&](const Progress& progress) {
    trusted = record.schema == "dynasurf.cloud/1" ? repeat_cloud(arguments, record, out, progress)
                                                  : repeat_ventricle(arguments, record, out, progress);
  });

  std::size_t compared = 0;
  const std::vector<std::string> different = differences(arguments.result, out, stop, compared);
  std::string text = alteration_of(arguments.result);
  if (different.empty()) {
    text += "same bytes: " + std::to_string(compared) + " files (times apart)\n";
  } else {
    text += std::to_string(different.size()) + " of " + std::to_string(compared) + " files differ:\n";
    for (const std::string& file : different) text += "  " + file + "\n";
    if (record.version != version() || record.commit != commit())
      text += "made by version " + record.version + " (" + record.commit + "), repeated by " + version() + " (" +
              commit() + ")\n";
  }
  if (arguments.out.is_asked()) text += "result: " + arguments.out.path + "\n";
  if (!arguments.quiet || !different.empty()) print(text);
  return different.empty() && trusted ? done : not_trustworthy;
}

}  // namespace

void add_rerun(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<RerunArguments>();
  CommandLine command(program, "rerun", "Repeat a run from its result folder and compare all bytes");
  command.option("RESULT", a->result, "folder of a former run").required();
  command.option("--input,--study", a->inputs,
                 "the study or the files of the cloud, when they are neither beside RESULT nor in the working folder");
  command.option("--mask", a->mask, "the mask of the run, likewise");
  command.option("--start", a->start, "the mesh its surfaces started from, likewise");
  add_out_folder(command, a->out, "keep the new result here; without it nothing is kept");
  command.option("--threads", a->threads, "threads at most (0: all)").within(0, 1024);
  command.flag("--quiet", a->quiet, "print nothing but what differs");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
