#pragma once
#include <cstddef>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dynasurf/cohort/detail/claims.hpp"
#include "dynasurf/cohort/status.hpp"

#include "batch_run.hpp"

namespace dynasurf::app {

/// Which studies of a shard are still to be run, shared with every other process that works on the cohort.
class StudyQueue {
 public:
  explicit StudyQueue(const BatchJob& job);

  /// Takes a study for this process; nothing when no study is left to take at this moment. Those that other processes
  /// work on stay in the queue.
  std::optional<std::size_t> take();
  /// Whether no study is left, also with other processes.
  bool is_empty() const { return waiting_.empty(); }
  /// Takes in what other processes have finished.
  void read_on() { status_.read_on(); }
  /// Appends the row of a study that was taken, and gives it back.
  void record(const cohort::StudyStatus& row);
  void give_back(const std::string& id) { claims_.release(id); }

  const cohort::CohortStudy& study(std::size_t n) const { return job_.list.studies[n]; }
  const cohort::StudyStatus* row_of(const std::string& id) const { return status_.find(id); }
  /// All studies of the shard.
  const std::vector<std::size_t>& mine() const { return mine_; }
  /// How many this process took.
  std::size_t taken() const { return taken_.size(); }

  /// What the study is run with, but for what leaves the result as it is.
  std::vector<std::string> words_of(const cohort::CohortStudy& study) const;
  std::string settings_of(const cohort::CohortStudy& study);
  BatchTally tally();

 private:
  enum class Need { none, run, someone_else };
  bool is_unchanged(const cohort::CohortStudy& study, const cohort::StudyStatus& row);
  bool has_to_run(const cohort::CohortStudy& study);
  Need claim(std::size_t n);

  const BatchJob& job_;
  cohort::Claims claims_;
  cohort::StatusFile status_;
  std::list<std::size_t> waiting_;  // in the order of the list
  std::vector<std::size_t> mine_;
  std::set<std::string> taken_;                        // ids
  std::map<std::string, std::string> started_before_;  // of the rows that stood when this process began, by id
  std::map<std::string, std::string> settings_;
};

}  // namespace dynasurf::app
