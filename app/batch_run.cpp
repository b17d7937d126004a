#include "batch_run.hpp"

#include <chrono>
#include <list>

#include <poll.h>

#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/staging.hpp"

#include "batch_end.hpp"
#include "batch_progress.hpp"
#include "batch_study.hpp"
#include "command.hpp"

namespace dynasurf::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int most_attempts = 2;
constexpr auto grace = std::chrono::milliseconds(400);  // between being asked to stop and being killed
constexpr auto look_again = std::chrono::milliseconds(200);

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

class Worker {
 public:
  Worker(const BatchJob& job, const std::stop_token& stop) : job_(job), stop_(stop), queue_(job) {}

  BatchTally run();

 private:
  void start_some();
  void begin(std::size_t n, int attempt);
  void watch();
  bool take_end(RunningStudy& running);
  void stop_all();

  const BatchJob& job_;
  const std::stop_token& stop_;
  StudyQueue queue_;
  std::list<RunningStudy> running_;
  Clock::time_point next_look_;
};

void Worker::start_some() {
  if (Clock::now() < next_look_) return;
  const auto has_room = [&] { return static_cast<int>(running_.size()) < job_.jobs; };
  while (has_room() && !stop_.stop_requested()) {
    const std::optional<std::size_t> n = queue_.take();
    if (!n) break;
    begin(*n, 1);
  }
  // What is left is done by others: they are looked at now and then.
  if (has_room() && !queue_.is_empty()) {
    next_look_ = Clock::now() + look_again;
    queue_.read_on();
  }
}

void Worker::begin(std::size_t n, int attempt) {
  RunningStudy running = start_study(queue_, n, attempt, job_);
  if (running.child)
    running_.push_back(std::move(running));
  else
    queue_.record(running.row);
}

/// Whether a child has ended; then its study is recorded, or begun once more.
bool Worker::take_end(RunningStudy& running) {
  const auto end = running.child->end();
  if (!end) return false;
  cohort::StudyStatus& row = running.row;
  row.wall_s = seconds_since(running.begin), row.cpu_s = end->cpu_s, row.peak_mb = end->peak_mb;
  const cohort::CohortStudy& of = queue_.study(running.study);
  judge({*end, running.child->words(), running.asked_to_stop.has_value()}, of, job_, row);
  const bool was_stopped = end->code == not_trustworthy && !row.done;  // it cleaned up after a signal
  if (!running.asked_to_stop && (is_from_outside(*end) || was_stopped) && row.attempts < most_attempts) {
    begin(running.study, row.attempts + 1);
    return true;
  }
  if (!row.done) io::staging::sweep(cohort::result_folder(job_.cohort, of.id));
  if (end->code == bad_usage && of.options.empty()) {
    queue_.give_back(of.id);
    throw OptionError(row.reason);
  }
  queue_.record(row);
  return true;
}

/// Waits until a child says something or ends, and takes the ends.
void Worker::watch() {
  std::vector<pollfd> descriptors;
  for (const RunningStudy& running : running_) descriptors.push_back({running.child->descriptor(), POLLIN, 0});
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
  for (const RunningStudy& running : running_) running.child->ask_to_stop();
  const auto end = Clock::now() + grace;
  while (!running_.empty() && Clock::now() < end) {
    std::erase_if(running_, [](const RunningStudy& running) { return running.child->end().has_value(); });
    if (!running_.empty()) ::poll(nullptr, 0, 5);
  }
  running_.clear();  // kills what is left
}

BatchTally Worker::run() {
  BatchProgress progress(job_.quiet, queue_.mine().size());
  try {
    while (!stop_.stop_requested()) {
      start_some();
      if (running_.empty() && queue_.is_empty()) break;
      watch();
      progress.tell([&](const std::string& id) { return queue_.row_of(id); }, queue_.mine(), job_.list, queue_.taken());
    }
  } catch (...) {
    stop_all();
    throw;
  }
  stop_all();
  progress.finish();
  queue_.read_on();
  BatchTally result = queue_.tally();
  result.stopped = stop_.stop_requested();
  return result;
}

}  // namespace

BatchTally run_batch(const BatchJob& job, const std::stop_token& stop) { return Worker(job, stop).run(); }

}  // namespace dynasurf::app
