#include "batch_progress.hpp"

#include <unistd.h>

#include "console.hpp"

namespace dynasurf::app {

std::string duration_text(double seconds) {
  if (seconds < 100) return fixed(seconds, 0) + " s";
  return seconds < 6000 ? fixed(seconds / 60, 0) + " min" : fixed(seconds / 3600, 1) + " h";
}

BatchProgress::BatchProgress(bool quiet, std::size_t studies)
    : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1), studies_(studies) {}

void BatchProgress::tell(const std::function<const cohort::StudyStatus*(const std::string&)>& row_of,
                         const std::vector<std::size_t>& mine, const cohort::StudyList& list, std::size_t run) {
  if (quiet_ || Clock::now() < next_) return;
  next_ = Clock::now() + (terminal_ ? std::chrono::milliseconds(500) : std::chrono::milliseconds(10000));
  std::size_t done = 0, failed = 0, to_check = 0;
  for (const std::size_t n : mine) {
    const cohort::StudyStatus* row = row_of(list.studies[n].id);
    if (!row) continue;
    ++(row->done ? done : failed);
    to_check += row->verdict == "check";
  }
  const std::size_t ended = done + failed;
  if (!has_counted_) counted_first_ = ended;
  has_counted_ = true;
  const double passed = std::chrono::duration<double>(Clock::now() - begin_).count();
  const double rate = passed > 0 ? (ended - counted_first_) / passed : 0;
  std::string text = std::to_string(done) + " of " + std::to_string(studies_) + " done, " + std::to_string(failed) +
                     " failed, " + std::to_string(to_check) + " to check";
  if (run > 0 && rate > 0)
    text += ", " + fixed(60 * rate, 1) + " studies/min, " + duration_text((studies_ - ended) / rate) + " left";
  print_live(text, terminal_);
  open_ = terminal_;
}

void BatchProgress::finish() {
  if (open_) print_live("", true);
  open_ = false;
}

}  // namespace dynasurf::app
