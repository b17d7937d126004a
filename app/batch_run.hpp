#pragma once
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "dynasurf/cohort/study_list.hpp"

namespace dynasurf::app {

/// Which studies are done although a row tells how they ended.
struct Again {
  bool failed = false;   // those that failed
  bool changed = false;  // those whose input, options or program changed since
  bool all = false;
};

/// Studies that one process runs, each in a child process.
struct BatchJob {
  std::filesystem::path cohort;
  cohort::StudyList list;             // all of the cohort's
  int shard = 1, shards = 1;          // of the list, study n belongs to shard n modulo shards
  std::string command = "ventricle";  // or cloud
  std::vector<std::string> options;   // of that command, for every study
  int jobs = 1, threads = 1;          // studies at a time, and threads of each
  double time_limit_s = 0;            // 0: none
  std::uint64_t memory_bytes = 0;     // of each study
  Again again;
  bool quiet = false;
};

/// How the studies of a batch stand, by their last rows.
struct BatchTally {
  std::size_t studies = 0, done = 0, failed = 0;
  std::size_t to_check = 0, not_trustworthy = 0;  // of those done: verdicts check and fail
  std::size_t changed = 0;                        // done, but with another input, options or program
  std::size_t run = 0;                            // by this process
  bool stopped = false;
};

/// Runs what is not done, and returns when every study of the shard has a row or `stop` is requested. Another process
/// that works on the same cohort never runs a study at the same time. Throws OptionError when the command does not
/// understand its options, IoError.
BatchTally run_batch(const BatchJob& job, const std::stop_token& stop);

}  // namespace dynasurf::app
