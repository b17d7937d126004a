#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/folder_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/detail/manifest.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"

#include "cloud_run.hpp"
#include "command.hpp"
#include "console.hpp"
#include "reconstruction.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Arguments {
  std::string result, mask, start;
  OutFolder out;
  std::vector<std::string> inputs;
  int threads = 0;
  bool quiet = false;
};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw IoError(path.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What a result folder tells of its making, whatever made it.
// NOLINTNEXTLINE(bugprone-exception-escape): the JSON library moves without throwing, though it does not say so.
struct Record {
  std::string schema, version, commit, command;
  Json options, outputs;
  bool timings = true;
  std::vector<std::string> names, hashes;  // of the inputs
  std::vector<std::uint64_t> bytes;        // likewise; empty where a former version did not tell
  std::string mask_hash, start_hash;       // empty: none was given
  std::string series;                      // that was chosen; likewise
};

[[noreturn]] void refuse(const fs::path& result, const std::string& what) {
  throw InputError((result / "results.json").string() + ": " + what);
}

/// A word that is printed as it stands, such as a version.
std::string plain_word_in(const io::JsonNode& object, const char* key) {
  constexpr std::size_t most = 100;
  std::string word = io::text_in(object, key);
  if (word.size() > most || !std::all_of(word.begin(), word.end(), [](char c) { return c >= ' ' && c <= '~'; }))
    throw InputError(object.file + ": " + object.path + "." + key + ": expected a plain word");
  return word;
}

Record record_of(const fs::path& result) {
  const fs::path file = io::file_inside(result, "results.json");
  const Json json = io::read_json(file);
  const io::JsonNode results = io::root_of(json, file.string());
  Record record;
  record.schema = io::text_in(results, "schema");
  if (record.schema != "dynasurf.ventricle/3" && record.schema != "dynasurf.cloud/1")
    refuse(result, "expected the schema dynasurf.ventricle/3 or dynasurf.cloud/1");
  const io::JsonNode provenance = io::object_in(results, "provenance");
  record.version = plain_word_in(provenance, "version");
  record.commit = plain_word_in(provenance, "commit");
  record.command = io::text_in(provenance, "command");
  record.options = *io::object_in(provenance, "options").json;
  record.outputs = *io::object_in(provenance, "outputs").json;
  record.timings = io::has(results, "timings_s");
  const io::JsonNode inputs = io::list_in(provenance, "inputs");
  for (std::size_t n = 0; n < io::size_of(inputs); ++n) {
    const io::JsonNode input = io::object_of(inputs, n);
    record.hashes.push_back(io::text_in(input, "sha256"));
    record.names.push_back(io::text_in(input, "file"));
    if (io::has(input, "bytes"))
      record.bytes.push_back(
          static_cast<std::uint64_t>(io::whole_in(input, "bytes", 0, std::numeric_limits<std::int64_t>::max())));
  }
  if (io::has(provenance, "given")) {
    const io::JsonNode given = io::object_in(provenance, "given");
    if (io::has(given, "series")) record.series = io::text_in(given, "series");
    if (io::has(given, "mask_sha256")) record.mask_hash = io::text_in(given, "mask_sha256");
    if (io::has(given, "start_mesh_sha256")) record.start_hash = io::text_in(given, "start_mesh_sha256");
  }
  if (record.hashes.empty()) refuse(result, "names no input");
  return record;
}

/// What was written beside numbers and meshes, to be looked at.
io::JsonNode outputs_of(const Arguments& arguments, const Record& record) {
  return {&record.outputs, (fs::path(arguments.result) / "results.json").string(), "provenance.outputs"};
}

std::vector<std::string> words_in(const io::JsonNode& object, const char* key) {
  const io::JsonNode list = io::list_in(object, key);
  std::vector<std::string> words;
  for (std::size_t n = 0; n < io::size_of(list); ++n) words.push_back(io::text_of(io::item_of(list, n)));
  return words;
}

/// YYYYMMDDHHMMSS.
std::string dicom_time_in(const io::JsonNode& outputs) {
  const std::string time = io::text_in(outputs, "dicom_time");
  if (time.size() != 14 || !std::all_of(time.begin(), time.end(), [](char c) { return c >= '0' && c <= '9'; }))
    throw InputError(outputs.file + ": " + outputs.path + ".dicom_time: expected 14 digits, YYYYMMDDHHMMSS");
  return time;
}

/// What every kind of run needs to be repeated.
void recall(const Arguments& arguments, const Record& record, const fs::path& out, ResultJob& job) {
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
    refuse(result, error.what());
  }
}

/// No reader takes a larger file: what is larger need not be hashed.
constexpr std::uintmax_t largest_input = std::uintmax_t{4} << 30;

bool may_be_input(const fs::path& file, const Record& record) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error || bytes > largest_input) return false;
  return record.bytes.empty() || std::find(record.bytes.begin(), record.bytes.end(), bytes) != record.bytes.end();
}

bool is_study(const fs::path& path, const Record& record) {
  try {
    const std::vector<fs::path> files = io::files_of_study(path, record.series);
    return files.size() == record.hashes.size() &&
           std::all_of(files.begin(), files.end(), [&](const fs::path& file) { return may_be_input(file, record); }) &&
           hashes_of_study(path, record.series) == record.hashes;
  } catch (const std::exception&) {
    return false;  // not a study at all
  }
}

/// What lies beside the result and in the working folder, where the files of a run are looked for.
std::vector<fs::path> places_beside(const Arguments& arguments) {
  const fs::path result = fs::weakly_canonical(arguments.result);
  std::vector<fs::path> all;
  for (const fs::path& place : {result.parent_path(), fs::current_path()}) {
    std::vector<fs::path> candidates;
    for (const auto& entry : fs::directory_iterator(place, fs::directory_options::skip_permission_denied))
      if (entry.path() != result && !fs::exists(entry.path() / "results.json") &&
          (entry.is_regular_file() || entry.is_directory()))
        candidates.push_back(entry.path());
    std::sort(candidates.begin(), candidates.end());
    all.insert(all.end(), candidates.begin(), candidates.end());
  }
  return all;
}

[[noreturn]] void throw_missing(const Arguments& arguments, const std::string& hash, const std::string& name) {
  throw InputError(arguments.result + ": its input (SHA-256 " + hash.substr(0, 12) +
                   "...) is neither beside it nor in the working folder; name it with " + name);
}

/// The study is known by its hash, not by its name, and looked for beside the result and in the working folder.
fs::path find_study(const Arguments& arguments, const Record& record) {
  if (arguments.inputs.size() > 1) throw OptionError("--input names more than one study");
  if (!arguments.inputs.empty()) {
    const std::string& study = arguments.inputs[0];
    if (hashes_of_study(study, record.series) != record.hashes)
      throw InputError(study + ": is not the study the result was made from (SHA-256 " +
                       record.hashes.front().substr(0, 12) + "... expected)");
    return study;
  }
  for (const fs::path& candidate : places_beside(arguments))
    if ((record.hashes.size() > 1 || !record.series.empty() || fs::is_regular_file(candidate)) &&
        is_study(candidate, record))
      return candidate;
  throw_missing(arguments, record.hashes.front(), "--study");
}

/// The files of a cloud, each known by its hash.
std::vector<fs::path> find_clouds(const Arguments& arguments, const Record& record) {
  std::vector<fs::path> candidates(arguments.inputs.begin(), arguments.inputs.end());
  if (candidates.empty())
    for (const fs::path& path : places_beside(arguments))
      if (fs::is_regular_file(path) && may_be_input(path, record)) candidates.push_back(path);
  std::map<std::string, fs::path> by_hash;
  for (const fs::path& path : candidates) try {
      by_hash.emplace(io::sha256_of_file(path), path);
    } catch (const IoError&) {
      if (!arguments.inputs.empty()) throw;  // what the user names must be readable
    }
  std::vector<fs::path> found;
  for (const std::string& hash : record.hashes) {
    const auto at = by_hash.find(hash);
    if (at == by_hash.end()) throw_missing(arguments, hash, "--input");
    found.push_back(at->second);
  }
  return found;
}

/// A file that was given beside the study, known by its hash too; empty when none was.
fs::path find_given(const Arguments& arguments, const std::string& hash, const std::string& named,
                    const std::string& what) {
  if (hash.empty()) return {};
  if (!named.empty()) {
    if (io::sha256_of_file(named) != hash)
      throw InputError(named + ": is not the " + what + " the result was made with (SHA-256 " + hash.substr(0, 12) +
                       "... expected)");
    return named;
  }
  for (const fs::path& candidate : places_beside(arguments))
    if (std::error_code error; fs::is_regular_file(candidate, error) &&
                               fs::file_size(candidate, error) <= largest_input &&
                               io::sha256_of_file(candidate) == hash)
      return candidate;
  throw InputError(arguments.result + ": its " + what + " (SHA-256 " + hash.substr(0, 12) +
                   "...) is neither beside it nor in the working folder; name it with --" + what);
}

/// What a result holds: what its manifest lists, but for what has gone. Everything where there is no manifest.
std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> files;
  if (fs::exists(folder / io::manifest_name)) {
    for (const io::ManifestEntry& file : io::read_manifest(folder))
      if (fs::exists(folder / file.name)) files.insert(file.name);
    return files;
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.insert(entry.path().lexically_relative(folder).string());
  return files;
}

/// A line for a result that is not as it was written.
std::string alteration_of(const fs::path& result) {
  if (!fs::exists(result / io::manifest_name)) return {};
  const auto foreign = io::first_foreign_file(result);
  return foreign ? foreign->name + " in it " + foreign->why + "\n" : std::string();
}

/// Times and memory are what a repeated run may tell otherwise. The printed pages are Chromium's, not ours: another
/// version may set them otherwise.
bool same(const fs::path& a, const fs::path& b, const std::string& file) {
  if (file == "report.pdf" || file == "dicom/report.dcm") return true;
  const std::string old_bytes = bytes_of(a);
  const std::string new_bytes = bytes_of(b);
  if (old_bytes == new_bytes) return true;
  if (file != "results.json") return false;
  Json old_json = io::parse_json(old_bytes, a.string());
  Json new_json = io::parse_json(new_bytes, b.string());
  for (const char* key : {"timings_s", "memory"}) {
    old_json.erase(key);
    new_json.erase(key);
  }
  return old_json == new_json;
}

std::vector<std::string> differences(const fs::path& before, const fs::path& after, const std::stop_token& stop,
                                     std::size_t& compared) {
  std::set<std::string> files = files_in(before);
  files.merge(files_in(after));
  compared = files.size();
  std::vector<std::string> different;
  for (const std::string& file : files) {
    if (stop.stop_requested()) throw Cancelled("stopped on request");
    if (!fs::exists(before / file) || !fs::exists(after / file) || !same(before / file, after / file, file))
      different.push_back(file);
  }
  return different;
}

/// Repeats the run into `out`; tells whether its result may be trusted.
bool repeat_ventricle(const Arguments& arguments, const Record& record, const fs::path& out, const Progress& progress) {
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

bool repeat_cloud(const Arguments& arguments, const Record& record, const fs::path& out, const Progress& progress) {
  CloudJob job = read_record(arguments.result, [&] {
    CloudJob read;
    io::options_from_json(record.options, read.options);
    recall(arguments, record, out, read);
    read.textures = io::flag_in(outputs_of(arguments, record), "textures");
    return read;
  });
  job.clouds = find_clouds(arguments, record);
  return report::is_trustworthy(reconstruct_cloud_to_folder(job, progress).run.result);
}

ExitCode run(const Arguments& arguments, std::stop_token stop) {
  const Record record = record_of(arguments.result);
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
  auto a = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand("rerun", "Repeat a run from its result folder and compare all bytes");
  command->add_option("RESULT", a->result, "folder of a former run")->required();
  command->add_option(
      "--input,--study", a->inputs,
      "the study or the files of the cloud, when they are neither beside RESULT nor in the working folder");
  command->add_option("--mask", a->mask, "the mask of the run, likewise");
  command->add_option("--start", a->start, "the mesh its surfaces started from, likewise");
  add_out_folder(*command, a->out, "keep the new result here; without it nothing is kept");
  command->add_option("--threads", a->threads, "threads at most (0: all)")->check(CLI::Range(0, 1024));
  command->add_flag("--quiet", a->quiet, "print nothing but what differs");
  command->callback([a, &chosen] { chosen = [a](std::stop_token stop) { return run(*a, stop); }; });
}

}  // namespace dynasurf::app
