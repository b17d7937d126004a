#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"

#include "command.hpp"
#include "console.hpp"
#include "reconstruction.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Arguments {
  std::string result, study, mask, start, out;
  int threads = 0;
  bool quiet = false;
};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw IoError(path.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What a result folder tells of its making.
struct Record {
  Job job;
  std::vector<std::string> hashes;
  std::string mask_hash, start_hash;  // empty: none was given
  std::string version, commit;
};

Record record_of(const fs::path& result) {
  const fs::path file = result / "results.json";
  const Json json = Json::parse(bytes_of(file), nullptr, false);
  const auto broken = [&](const std::string& what) { throw InputError(file.string() + ": " + what); };
  if (json.is_discarded()) broken("is no JSON");
  Record record;
  try {
    if (json.at("schema") != "dynasurf.ventricle/1") broken("expected the schema dynasurf.ventricle/1");
    const Json& provenance = json.at("provenance");
    record.version = provenance.at("version").get<std::string>();
    record.commit = provenance.at("commit").get<std::string>();
    record.job.command = provenance.at("command").get<std::string>();
    options_from_json(provenance.at("options"), record.job.options);
    for (const Json& input : provenance.at("inputs")) {
      record.hashes.push_back(input.at("sha256").get<std::string>());
      record.job.recorded_names.push_back(input.at("file").get<std::string>());
    }
    const Json given = provenance.value("given", Json::object());
    const auto hash = [&](const char* key) {
      return given.contains(key) && given.at(key).is_string() ? given.at(key).get<std::string>() : std::string();
    };
    record.mask_hash = hash("mask_sha256"), record.start_hash = hash("start_mesh_sha256");
    const Json& outputs = provenance.at("outputs");
    record.job.outputs.mesh_formats.clear();
    for (const Json& word : outputs.at("mesh_formats"))
      record.job.outputs.mesh_formats.push_back(static_cast<MeshFormat>(
          position_of(names_of(MeshFormat{}), word.get<std::string>(), "outputs.mesh_formats")));
    record.job.outputs.keep_stages = outputs.at("keep_stages").get<bool>();
    record.job.outputs.timings = !json.at("timings_s").is_null();
  } catch (const Json::exception& error) {
    broken(std::string("is not a result of this program: ") + error.what());
  } catch (const OptionError& error) {
    broken(error.what());
  }
  if (record.hashes.empty()) broken("names no input");
  return record;
}

bool is_study(const fs::path& path, const Record& record) {
  try {
    return hashes_of_study(path) == record.hashes;
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

/// The study is known by its hash, not by its name.
fs::path find_study(const Arguments& arguments, const Record& record) {
  if (!arguments.study.empty()) {
    if (hashes_of_study(arguments.study) != record.hashes)
      throw InputError(arguments.study + ": is not the study the result was made from (SHA-256 " +
                       record.hashes.front().substr(0, 12) + "... expected)");
    return arguments.study;
  }
  for (const fs::path& candidate : places_beside(arguments))
    if ((record.hashes.size() > 1 || fs::is_regular_file(candidate)) && is_study(candidate, record)) return candidate;
  throw InputError(arguments.result + ": its study (SHA-256 " + record.hashes.front().substr(0, 12) +
                   "...) is neither beside it nor in the working folder; name it with --study");
}

/// A file that was given beside the study, known by its hash too; empty when none was.
fs::path find_given(const Arguments& arguments, const std::string& hash, const std::string& named,
                    const std::string& what) {
  if (hash.empty()) return {};
  if (!named.empty()) {
    if (sha256_of_file(named) != hash)
      throw InputError(named + ": is not the " + what + " the result was made with (SHA-256 " + hash.substr(0, 12) +
                       "... expected)");
    return named;
  }
  for (const fs::path& candidate : places_beside(arguments))
    if (fs::is_regular_file(candidate) && sha256_of_file(candidate) == hash) return candidate;
  throw InputError(arguments.result + ": its " + what + " (SHA-256 " + hash.substr(0, 12) +
                   "...) is neither beside it nor in the working folder; name it with --" + what);
}

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.insert(entry.path().lexically_relative(folder).string());
  return files;
}

/// Times are the one thing that a repeated run may tell otherwise.
bool same(const fs::path& a, const fs::path& b, const std::string& file) {
  const std::string old_bytes = bytes_of(a);
  const std::string new_bytes = bytes_of(b);
  if (old_bytes == new_bytes) return true;
  if (file != "results.json") return false;
  Json old_json = Json::parse(old_bytes, nullptr, false);
  Json new_json = Json::parse(new_bytes, nullptr, false);
  old_json.erase("timings_s");
  new_json.erase("timings_s");
  return old_json == new_json;
}

std::vector<std::string> differences(const fs::path& before, const fs::path& after, std::size_t& compared) {
  std::set<std::string> files = files_in(before);
  files.merge(files_in(after));
  compared = files.size();
  std::vector<std::string> different;
  for (const std::string& file : files)
    if (!fs::exists(before / file) || !fs::exists(after / file) || !same(before / file, after / file, file))
      different.push_back(file);
  return different;
}

/// A folder beside the result that goes away again.
class ScratchFolder {
 public:
  explicit ScratchFolder(const fs::path& result)
      : path_(fs::weakly_canonical(result).string() + ".rerun-" + std::to_string(::getpid())) {}
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

ExitCode run(const Arguments& arguments, std::stop_token stop) {
  Record record = record_of(arguments.result);
  record.job.study = find_study(arguments, record);
  record.job.mask = find_given(arguments, record.mask_hash, arguments.mask, "mask");
  record.job.start_mesh = find_given(arguments, record.start_hash, arguments.start, "start");
  record.job.threads = arguments.threads;
  const ScratchFolder scratch(arguments.result);
  record.job.out = arguments.out.empty() ? scratch.path() : fs::path(arguments.out);
  // Compared before anything is replaced: --out may name the result itself.
  if (!arguments.out.empty() && fs::exists(arguments.out) && fs::equivalent(arguments.out, arguments.result))
    throw OptionError("--out names the result itself; leave it out to compare without keeping");

  ProgressLine line(arguments.quiet);
  const Progress progress{[&](std::string_view stage, int done, int total) { line(stage, done, total); }, stop};
  const Outcome outcome = reconstruct_to_folder(record.job, progress);
  line.finish();

  std::size_t compared = 0;
  const std::vector<std::string> different = differences(arguments.result, record.job.out, compared);
  std::string text;
  if (different.empty()) {
    text = "same bytes: " + std::to_string(compared) + " files (times apart)\n";
  } else {
    text = std::to_string(different.size()) + " of " + std::to_string(compared) + " files differ:\n";
    for (const std::string& file : different) text += "  " + file + "\n";
    if (record.version != version() || record.commit != commit())
      text += "made by version " + record.version + " (" + record.commit + "), repeated by " + version() + " (" +
              commit() + ")\n";
  }
  if (!arguments.out.empty()) text += "result: " + arguments.out + "\n";
  if (!arguments.quiet || !different.empty()) print(text);
  return different.empty() && outcome.result.verdict != Verdict::fail ? done : not_trustworthy;
}

}  // namespace

void add_rerun(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand("rerun", "Repeat a run from its result folder and compare all bytes");
  command->add_option("RESULT", a->result, "folder of a former run")->required();
  command->add_option("--study", a->study, "the study, when it is neither beside RESULT nor in the working folder");
  command->add_option("--mask", a->mask, "the mask of the run, likewise");
  command->add_option("--start", a->start, "the mesh its surfaces started from, likewise");
  command->add_option("--out", a->out, "keep the new result here; without it nothing is kept");
  command->add_option("--threads", a->threads, "threads at most (0: all)")->check(CLI::Range(0, 1024));
  command->add_flag("--quiet", a->quiet, "print nothing but what differs");
  command->callback([a, &chosen] { chosen = [a](std::stop_token stop) { return run(*a, stop); }; });
}

}  // namespace dynasurf::app
