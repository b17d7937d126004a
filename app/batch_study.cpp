#include "batch_study.hpp"

#include <ctime>

#include <unistd.h>

#include "dynasurf/cohort/detail/job_key.hpp"

#include "batch_end.hpp"
#include "debug_fault.hpp"
#include "utf8.hpp"

namespace dynasurf::app {
namespace {

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

}  // namespace

RunningStudy start_study(StudyQueue& queue, std::size_t n, int attempt, const BatchJob& job) {
  const cohort::CohortStudy& wanted = queue.study(n);
  RunningStudy running;
  running.study = n;
  cohort::StudyStatus& row = running.row;
  row.id = wanted.id, row.attempts = attempt, row.started = time_text(), row.host = host_name();
  row.settings = queue.settings_of(wanted);
  try {
    row.input_stamp = cohort::input_stamp(wanted.path);
    row.input_sha256 = cohort::input_hash(wanted.path);
  } catch (const std::runtime_error& error) {
    row.reason = without_names(printable(error.what()), wanted.path);
    return running;
  }
  std::vector<std::string> words = queue.words_of(wanted);
  words[0] = "/proc/self/exe";
  words.insert(words.begin() + 1,
               {job.command, wanted.path.string(), "--out", cohort::result_folder(job.cohort, wanted.id).string(),
                "--quiet", "--no-timings", "--threads", std::to_string(job.threads)});
  if (job.memory_bytes > 0) words.insert(words.end(), {"--memory-limit", std::to_string(job.memory_bytes)});
  std::vector<std::string> variables;
  if (const std::string fault = debug_fault_of(wanted.id); !fault.empty()) variables.push_back(fault);
  running.begin = RunningStudy::Clock::now();
  running.child = std::make_unique<ChildProgram>(words, variables, job.memory_bytes);
  return running;
}

}  // namespace dynasurf::app
