#include "batch_queue.hpp"

#include <nlohmann/json.hpp>

#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/core/error.hpp"

#include "version.hpp"

namespace dynasurf::app {

StudyQueue::StudyQueue(const BatchJob& job)
    : job_(job), claims_(job.cohort / "claims"), status_(job.cohort / "status.tsv") {
  for (std::size_t n = 0; n < job.list.studies.size(); ++n)
    if (static_cast<int>(n % job.shards) == job.shard - 1) waiting_.push_back(n);
  mine_ = {waiting_.begin(), waiting_.end()};
  for (const auto& [id, row] : status_.all()) started_before_[id] = row.started;
}

std::optional<std::size_t> StudyQueue::take() {
  for (auto at = waiting_.begin(); at != waiting_.end();) {
    const std::size_t n = *at;
    const Need need = claim(n);
    // What others work on stays: their process may end without finishing it.
    at = need == Need::someone_else ? std::next(at) : waiting_.erase(at);
    if (need != Need::run) continue;
    taken_.insert(study(n).id);
    return n;
  }
  return std::nullopt;
}

void StudyQueue::record(const cohort::StudyStatus& row) {
  // The row first: a study without a row and without a claim would be run again.
  status_.append(row);
  claims_.release(row.id);
}

std::vector<std::string> StudyQueue::words_of(const cohort::CohortStudy& study) const {
  std::vector<std::string> words{job_.command};
  if (!study.series.empty()) words.insert(words.end(), {"--series", study.series});
  if (study.fwhm_mm) words.insert(words.end(), {"--fwhm", nlohmann::json(*study.fwhm_mm).dump()});
  words.insert(words.end(), job_.options.begin(), job_.options.end());
  words.insert(words.end(), study.options.begin(), study.options.end());
  return words;
}

std::string StudyQueue::settings_of(const cohort::CohortStudy& study) {
  const std::vector<std::string> words = words_of(study);
  std::string key;
  for (const std::string& word : words) key += word + '\n';
  const auto [at, is_new] = settings_.emplace(key, "");
  if (is_new) at->second = cohort::settings_hash(words, std::string(version()) + " " + commit());
  return at->second;
}

/// An input with another time of change is read: copying a cohort leaves it unchanged.
bool StudyQueue::is_unchanged(const cohort::CohortStudy& study, const cohort::StudyStatus& row) {
  if (row.settings != settings_of(study)) return false;
  if (row.input_stamp == cohort::input_stamp(study.path)) return true;
  try {
    return cohort::input_hash(study.path) == row.input_sha256;
  } catch (const IoError&) {
    return false;
  }
}

bool StudyQueue::has_to_run(const cohort::CohortStudy& study) {
  const cohort::StudyStatus* row = status_.find(study.id);
  if (!row) return true;
  // A row that came since this process began answers --again.
  const auto before = started_before_.find(study.id);
  if (before == started_before_.end() || before->second != row->started) return false;
  if (job_.again.all || (job_.again.failed && !row->done)) return true;
  return job_.again.changed && !is_unchanged(study, *row);
}

/// Takes a study, unless another process works on it or has finished it meanwhile.
StudyQueue::Need StudyQueue::claim(std::size_t n) {
  const cohort::CohortStudy& wanted = study(n);
  if (!has_to_run(wanted)) return Need::none;
  if (!claims_.take(wanted.id)) return Need::someone_else;
  // Another process may have finished it between the look and the claim.
  status_.read_on();
  if (has_to_run(wanted)) return Need::run;
  claims_.release(wanted.id);
  return Need::none;
}

BatchTally StudyQueue::tally() {
  BatchTally tally;
  tally.studies = mine_.size();
  tally.run = taken_.size();
  for (const std::size_t n : mine_) {
    const cohort::StudyStatus* row = row_of(study(n).id);
    if (!row) continue;
    ++(row->done ? tally.done : tally.failed);
    tally.to_check += row->verdict == "check";
    tally.not_trustworthy += row->verdict == "fail";
    if (row->done && !taken_.contains(row->id) && !is_unchanged(study(n), *row)) ++tally.changed;
  }
  return tally;
}

}  // namespace dynasurf::app
