#pragma once
#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "dynasurf/cohort/status.hpp"
#include "dynasurf/cohort/study_list.hpp"

namespace dynasurf::app {

/// The line that tells how far a batch has come: done, failed, to check, studies a minute, time left. Written over on a
/// terminal ten times a second at most; elsewhere a line every ten seconds.
class BatchProgress {
 public:
  BatchProgress(bool quiet, std::size_t studies);

  /// `run` studies were begun by this process; rows are counted anew, which costs time only when a line is due.
  void tell(const std::function<const cohort::StudyStatus*(const std::string&)>& row_of,
            const std::vector<std::size_t>& mine, const cohort::StudyList& list, std::size_t run);
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  bool quiet_, terminal_, open_ = false;
  std::size_t studies_, counted_first_ = 0;
  bool has_counted_ = false;
  Clock::time_point begin_ = Clock::now(), next_ = Clock::now();
};

/// "75 s", "12 min", "3.4 h".
std::string duration_text(double seconds);

}  // namespace dynasurf::app
