#include "batch_end.hpp"

#include <algorithm>
#include <csignal>

#include <nlohmann/json.hpp>

#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"

#include "command.hpp"
#include "console.hpp"
#include "utf8.hpp"

namespace dynasurf::app {
namespace {

/// The last error that a process told; empty when it told none.
std::string last_error_in(const std::string& words) {
  constexpr std::string_view sign = "dynasurf: error: ";
  const std::size_t at = words.rfind(sign);
  if (at == std::string::npos) return {};
  const std::string rest = words.substr(at + sign.size());
  return rest.substr(0, rest.find('\n'));
}

std::string verdict_of(const std::filesystem::path& result) {
  const std::filesystem::path file = result / "results.json";
  const nlohmann::ordered_json json = io::read_json(file);
  const io::JsonNode root = io::root_of(json, file.string());
  if (io::has(root, "quality")) return io::text_in(io::object_in(root, "quality"), "verdict");
  return io::text_in(root, "verdict");  // a cloud
}

}  // namespace

std::string without_names(std::string message, const std::filesystem::path& input) {
  constexpr std::string_view colon = ": ";
  const std::string name = printable(input.string());
  if (name.empty()) return message;
  for (std::size_t at = message.find(name); at != std::string::npos; at = message.find(name, at)) {
    const std::size_t end = at + name.size();
    const bool is_inside = message.compare(end, 1, "/") == 0;
    const std::size_t until = is_inside ? std::min(message.find(colon, end), message.size()) : end;
    const bool leads = at == 0 && !is_inside && message.compare(until, colon.size(), colon) == 0;
    const std::string instead = leads ? "" : is_inside ? "one of its files" : "the input";
    message.replace(at, until - at + (leads ? colon.size() : 0), instead);
    at += instead.size();
  }
  return message;
}

bool is_from_outside(const ChildEnd& end) {
  return !end.code && end.signal != SIGSEGV && end.signal != SIGABRT && end.signal != SIGBUS && end.signal != SIGFPE &&
         end.signal != SIGILL;
}

void judge(const StudyEnd& end, const cohort::CohortStudy& study, const BatchJob& job, cohort::StudyStatus& row) {
  const std::string error = without_names(last_error_in(end.words), study.path);
  const std::optional<int> code = end.process.code;
  if (end.was_too_slow) {
    row.reason = "took longer than the time limit of " + fixed(job.time_limit_s, 0) + " s";
  } else if (code == done || (code == not_trustworthy && error.empty())) {
    try {
      row.verdict = verdict_of(cohort::result_folder(job.cohort, study.id));
      row.done = true;
    } catch (const std::runtime_error& failure) {
      row.reason = failure.what();
    }
  } else if (code) {
    row.reason = error.empty() ? "ended with exit code " + std::to_string(*code) : error;
    if (error == "out of memory") row.reason += "; the limit is " + memory_text(job.memory_bytes);
  } else {
    row.reason = (is_from_outside(end.process) ? "killed from outside, signal " : "crashed, signal ") +
                 std::to_string(end.process.signal);
  }
}

}  // namespace dynasurf::app
