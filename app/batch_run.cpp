#include "batch_run.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>
#include <poll.h>
#include <unistd.h>

#include "dynasurf/cohort/detail/claims.hpp"
#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/cohort/status.hpp"
#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/detail/staging.hpp"

#include "batch_progress.hpp"
#include "batch_reason.hpp"
#include "child_process.hpp"
#include "command.hpp"
#include "console.hpp"
#include "debug_fault.hpp"
#include "utf8.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int most_attempts = 2;
constexpr auto grace = std::chrono::milliseconds(400);  // between being asked to stop and being killed
constexpr auto look_again = std::chrono::milliseconds(200);

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::string time_text() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string host_name() {
  char name[256] = {};
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

std::string verdict_of(const fs::path& result) {
  const fs::path file = result / "results.json";
  const nlohmann::ordered_json json = io::read_json(file);
  const io::JsonNode root = io::root_of(json, file.string());
  if (io::has(root, "quality")) return io::text_in(io::object_in(root, "quality"), "verdict");
  return io::flag_in(root, "watertight") ? "ok" : "fail";  // a cloud
}

bool is_from_outside(int signal) {
  return signal != SIGSEGV && signal != SIGABRT && signal != SIGBUS && signal != SIGFPE && signal != SIGILL;
}

enum class Need { none, run, someone_else };

struct Running {
  std::size_t study = 0;
  cohort::StudyStatus row;
  Clock::time_point begin;
  std::unique_ptr<ChildProgram> child;
  std::optional<Clock::time_point> asked_to_stop;  // since when
};

class Worker {
 public:
  Worker(const BatchJob& job, const std::stop_token& stop)
      : job_(job), stop_(stop), claims_(job.cohort / "claims"), status_(job.cohort / "status.tsv"), host_(host_name()) {
    for (std::size_t n = 0; n < job.list.studies.size(); ++n)
      if (static_cast<int>(n % static_cast<std::size_t>(job.shards)) == job.shard - 1) waiting_.push_back(n);
    mine_ = {waiting_.begin(), waiting_.end()};
    for (const auto& [id, row] : status_.all()) started_before_[id] = row.started;
  }

  BatchTally run();

 private:
  const cohort::CohortStudy& study(std::size_t n) const { return job_.list.studies[n]; }
  std::vector<std::string> words_of(const cohort::CohortStudy& study) const;
  std::string settings_of(const cohort::CohortStudy& study);
  bool is_unchanged(const cohort::CohortStudy& study, const cohort::StudyStatus& row);
  bool has_to_run(const cohort::CohortStudy& study);
  Need claim(std::size_t n);
  void start_some();
  void begin(std::size_t n, int attempt);
  void watch();
  bool take_end(Running& running);
  void record(const cohort::CohortStudy& study, const cohort::StudyStatus& row);
  void judge(const Running& running, const ChildEnd& end, cohort::StudyStatus& row) const;
  void stop_all();
  BatchTally tally();

  const BatchJob& job_;
  const std::stop_token& stop_;
  cohort::Claims claims_;
  cohort::StatusFile status_;
  std::string host_;
  std::list<std::size_t> waiting_;  // in the order of the list
  std::vector<std::size_t> mine_;   // all of the shard
  std::list<Running> running_;
  std::set<std::string> run_here_;                     // ids
  std::map<std::string, std::string> started_before_;  // of the rows that stood when this process began, by id
  std::map<std::string, std::string> settings_;
  Clock::time_point next_look_;
};

/// What the study is run with, but for what leaves the result as it is.
std::vector<std::string> Worker::words_of(const cohort::CohortStudy& study) const {
  std::vector<std::string> words{job_.command};
  if (!study.series.empty()) words.insert(words.end(), {"--series", study.series});
  if (study.fwhm_mm) words.insert(words.end(), {"--fwhm", nlohmann::json(*study.fwhm_mm).dump()});
  words.insert(words.end(), job_.options.begin(), job_.options.end());
  words.insert(words.end(), study.options.begin(), study.options.end());
  return words;
}

std::string Worker::settings_of(const cohort::CohortStudy& study) {
  const std::vector<std::string> words = words_of(study);
  std::string key;
  for (const std::string& word : words) key += word + '\n';
  const auto [at, is_new] = settings_.emplace(key, "");
  if (is_new) at->second = cohort::settings_hash(words, std::string(version()) + " " + commit());
  return at->second;
}

/// An input with another time of change is read: copying a cohort leaves it unchanged.
bool Worker::is_unchanged(const cohort::CohortStudy& study, const cohort::StudyStatus& row) {
  if (row.settings != settings_of(study)) return false;
  if (row.input_stamp == cohort::input_stamp(study.path)) return true;
  try {
    return cohort::input_hash(study.path) == row.input_sha256;
  } catch (const IoError&) {
    return false;
  }
}

bool Worker::has_to_run(const cohort::CohortStudy& study) {
  const cohort::StudyStatus* row = status_.find(study.id);
  if (!row) return true;
  // A row that came since this process began answers --again.
  const auto before = started_before_.find(study.id);
  if (before == started_before_.end() || before->second != row->started) return false;
  if (job_.again.all || (job_.again.failed && !row->done)) return true;
  return job_.again.changed && !is_unchanged(study, *row);
}

/// Takes a study, unless another process works on it or has finished it meanwhile.
Need Worker::claim(std::size_t n) {
  const cohort::CohortStudy& wanted = study(n);
  if (!has_to_run(wanted)) return Need::none;
  if (!claims_.take(wanted.id)) return Need::someone_else;
  status_.read_on();
  if (has_to_run(wanted)) return Need::run;
  claims_.release(wanted.id);
  return Need::none;
}

void Worker::start_some() {
  if (Clock::now() < next_look_) return;
  for (auto at = waiting_.begin();
       at != waiting_.end() && static_cast<int>(running_.size()) < job_.jobs && !stop_.stop_requested();) {
    const Need need = claim(*at);
    if (need == Need::run) begin(*at, 1);
    at = need == Need::someone_else ? std::next(at) : waiting_.erase(at);
  }
  // What is left is done by others: they are looked at now and then.
  if (static_cast<int>(running_.size()) < job_.jobs && !waiting_.empty()) {
    next_look_ = Clock::now() + look_again;
    status_.read_on();
  }
}

void Worker::begin(std::size_t n, int attempt) {
  const cohort::CohortStudy& wanted = study(n);
  run_here_.insert(wanted.id);
  Running running;
  running.study = n;
  cohort::StudyStatus& row = running.row;
  row.id = wanted.id, row.attempts = attempt, row.started = time_text(), row.host = host_;
  row.settings = settings_of(wanted);
  try {
    row.input_stamp = cohort::input_stamp(wanted.path);
    row.input_sha256 = cohort::input_hash(wanted.path);
  } catch (const std::runtime_error& error) {
    row.reason = without_names(printable(error.what()), wanted.path);
    record(wanted, row);
    return;
  }
  std::vector<std::string> words = words_of(wanted);
  words[0] = "/proc/self/exe";
  words.insert(words.begin() + 1,
               {job_.command, wanted.path.string(), "--out", cohort::result_folder(job_.cohort, wanted.id).string(),
                "--quiet", "--no-timings", "--threads", std::to_string(job_.threads)});
  if (job_.memory_bytes > 0) words.insert(words.end(), {"--memory-limit", std::to_string(job_.memory_bytes)});
  std::vector<std::string> variables;
  if (const std::string fault = debug_fault_of(wanted.id); !fault.empty()) variables.push_back(fault);
  running.begin = Clock::now();
  running.child = std::make_unique<ChildProgram>(words, variables, job_.memory_bytes);
  running_.push_back(std::move(running));
}

void Worker::record(const cohort::CohortStudy& of, const cohort::StudyStatus& row) {
  status_.append(row);
  claims_.release(of.id);
}

/// What the end of a child says of its study.
void Worker::judge(const Running& running, const ChildEnd& end, cohort::StudyStatus& row) const {
  const cohort::CohortStudy& of = study(running.study);
  const std::string words = reason_in(running.child->words(), of.path);
  if (running.asked_to_stop) {
    row.reason = "took longer than the time limit of " + fixed(job_.time_limit_s, 0) + " s";
  } else if (end.code == done || (end.code == not_trustworthy && words.empty())) {
    try {
      row.verdict = verdict_of(cohort::result_folder(job_.cohort, of.id));
      row.done = true;
    } catch (const std::runtime_error& error) {
      row.reason = error.what();
    }
  } else if (end.code) {
    row.reason = words.empty() ? "ended with exit code " + std::to_string(*end.code) : words;
    if (words == "out of memory") row.reason += "; the limit is " + memory_text(job_.memory_bytes);
  } else {
    row.reason = (is_from_outside(end.signal) ? "killed from outside, signal " : "crashed, signal ") +
                 std::to_string(end.signal);
  }
}

/// Whether a child has ended; then its study is recorded, or begun once more.
bool Worker::take_end(Running& running) {
  const auto end = running.child->end();
  if (!end) return false;
  cohort::StudyStatus& row = running.row;
  row.wall_s = seconds_since(running.begin), row.cpu_s = end->cpu_s, row.peak_mb = end->peak_mb;
  judge(running, *end, row);
  const cohort::CohortStudy& of = study(running.study);
  const bool was_stopped = end->code == not_trustworthy && !row.done;  // it cleaned up after a signal
  const bool was_killed = !end->code && is_from_outside(end->signal);
  if (!running.asked_to_stop && (was_killed || was_stopped) && row.attempts < most_attempts) {
    begin(running.study, row.attempts + 1);
    return true;
  }
  if (!row.done) io::staging::sweep(cohort::result_folder(job_.cohort, of.id));
  if (end->code == bad_usage && of.options.empty()) {
    claims_.release(of.id);
    throw OptionError(row.reason);
  }
  record(of, row);
  return true;
}

/// Waits until a child says something or ends, and takes the ends.
void Worker::watch() {
  std::vector<pollfd> descriptors;
  for (const Running& running : running_) descriptors.push_back({running.child->descriptor(), POLLIN, 0});
  ::poll(descriptors.data(), descriptors.size(), 20);
  for (auto at = running_.begin(); at != running_.end();) {
    if (take_end(*at)) {
      at = running_.erase(at);
      continue;
    }
    if (at->asked_to_stop && Clock::now() > *at->asked_to_stop + grace) at->child->kill();
    if (job_.time_limit_s > 0 && !at->asked_to_stop && seconds_since(at->begin) > job_.time_limit_s) {
      at->asked_to_stop = Clock::now();
      at->child->ask_to_stop();
    }
    ++at;
  }
}

void Worker::stop_all() {
  for (const Running& running : running_) running.child->ask_to_stop();
  const auto end = Clock::now() + grace;
  while (!running_.empty() && Clock::now() < end) {
    std::erase_if(running_, [](const Running& running) { return running.child->end().has_value(); });
    if (!running_.empty()) ::poll(nullptr, 0, 5);
  }
  running_.clear();  // kills what is left
}

BatchTally Worker::tally() {
  BatchTally tally;
  tally.studies = mine_.size();
  tally.run = run_here_.size();
  for (const std::size_t n : mine_) {
    const cohort::StudyStatus* row = status_.find(study(n).id);
    if (!row) continue;
    ++(row->done ? tally.done : tally.failed);
    tally.to_check += row->verdict == "check";
    tally.not_trustworthy += row->verdict == "fail";
    if (row->done && !run_here_.contains(row->id) && !is_unchanged(study(n), *row)) ++tally.changed;
  }
  return tally;
}

BatchTally Worker::run() {
  BatchProgress progress(job_.quiet, mine_.size());
  try {
    while (!stop_.stop_requested()) {
      start_some();
      if (running_.empty() && waiting_.empty()) break;
      watch();
      progress.tell([&](const std::string& id) { return status_.find(id); }, mine_, job_.list, run_here_.size());
    }
  } catch (...) {
    stop_all();
    throw;
  }
  stop_all();
  progress.finish();
  status_.read_on();
  BatchTally result = tally();
  result.stopped = stop_.stop_requested();
  return result;
}

}  // namespace

BatchTally run_batch(const BatchJob& job, const std::stop_token& stop) { return Worker(job, stop).run(); }

}  // namespace dynasurf::app
