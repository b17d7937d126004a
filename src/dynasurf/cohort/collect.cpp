#include "dynasurf/cohort/collect.hpp"

#include <algorithm>
#include <charconv>
#include <memory>

#include "dynasurf/cohort/detail/cohort_page.hpp"
#include "dynasurf/cohort/detail/cohort_statistics.hpp"
#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/cohort/detail/table_writer.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"

namespace dynasurf::cohort {
namespace {

namespace fs = std::filesystem;
using namespace detail;

Column column(const std::string& name, CellType type, const std::string& meaning) {
  Column made;
  made.name = name, made.type = type, made.meaning = meaning, made.unit = unit_in(name);
  return made;
}

/// What is told of every study, whether it has a result or not.
std::vector<Column> columns_of_runs(const std::vector<std::string>& groups) {
  std::vector<Column> columns{column("id", CellType::text, "name of the study in the cohort")};
  for (const std::string& group : groups)
    columns.push_back(column(group, CellType::text, "column of the table of studies"));
  columns.insert(columns.end(),
                 {column("state", CellType::text, "done, failed, or not_run"),
                  column("verdict", CellType::text, "ok, check or fail; empty without a result"),
                  column("flags", CellType::text, "codes of the reasons to distrust the result, the worst first"),
                  column("reason", CellType::text, "why there is no result"),
                  column("manual_decision", CellType::text, "accepted or rejected by a reader; empty: nobody decided"),
                  column("manual_reader", CellType::text, "who decided"),
                  column("manual_comment", CellType::text, "why, in the reader's words"),
                  column("attempts", CellType::whole, "how often it was run, since it was killed from outside"),
                  column("started", CellType::text, "when its run began, UTC"),
                  column("wall_s", CellType::real, "how long it took"),
                  column("cpu_s", CellType::real, "processor time that it took"),
                  column("peak_mb", CellType::real, "most memory in use"),
                  column("input_sha256", CellType::text, "SHA-256 of the input"),
                  column("settings", CellType::text, "short hash of options and program: equal where these are"),
                  column("report", CellType::text, "its report, from the folder of the tables")});
  return columns;
}

/// The tables of one cohort while they are filled.
class Tables {
 public:
  Tables(const fs::path& folder, const fs::path& published, const fs::path& cohort)
      : folder_(folder), published_(published), cohort_(cohort), database_(folder / "cohort.sqlite") {}

  void add(const CohortCase& one, const std::vector<std::string>& groups, const Json* results);
  void finish(const std::vector<std::string>& groups, const std::vector<StatisticRow>& statistics);

 private:
  void open(const std::vector<std::string>& groups, const std::string& schema);
  void add_list(const std::string& id, const Json& results, const std::vector<std::string>& path,
                const std::vector<Column>& columns, TableWriter* table) const;
  std::unique_ptr<TableWriter> table(const std::string& name, std::vector<Column> own, const std::vector<Column>& more);
  void write_dictionary();

  fs::path folder_, published_, cohort_;
  SqliteFile database_;
  std::string schema_;
  std::vector<std::pair<std::string, Column>> dictionary_;
  std::vector<Column> results_, segments_, gates_;
  std::unique_ptr<TableWriter> study_table_, segment_table_, curve_table_;
  std::vector<std::vector<std::string>> before_;  // studies without a result, until the first result tells the schema
};

std::unique_ptr<TableWriter> Tables::table(const std::string& name, std::vector<Column> own,
                                           const std::vector<Column>& more) {
  own.insert(own.end(), more.begin(), more.end());
  for (const Column& one : own) dictionary_.emplace_back(name, one);
  return std::make_unique<TableWriter>(folder_ / (name + ".tsv"), database_, name, own);
}

/// Columns of the results that a run's columns have the name of are left to the latter.
void Tables::open(const std::vector<std::string>& groups, const std::string& schema) {
  schema_ = schema;
  const Json& described = schema_of(schema);
  const std::vector<Column> runs = columns_of_runs(groups);
  results_ = scalar_columns(described, described);
  std::erase_if(results_, [&](const Column& result) {
    return std::any_of(runs.begin(), runs.end(), [&](const Column& run) { return run.name == result.name; });
  });
  segments_ = item_columns(described, {"measures", "segments"});
  gates_ = item_columns(described, {"gates"});
  const Column id = column("id", CellType::text, "name of the study in the cohort");
  study_table_ = table("studies", runs, results_);
  if (!segments_.empty()) segment_table_ = table("segments", {id}, segments_);
  if (!gates_.empty()) curve_table_ = table("curves", {id}, gates_);
  for (std::vector<std::string>& cells : before_) {
    cells.resize(cells.size() + results_.size());
    study_table_->add(cells);
  }
  before_.clear();
}

std::string fixed_text(double value) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, 3).ptr};
}

void Tables::add_list(const std::string& id, const Json& results, const std::vector<std::string>& path,
                      const std::vector<Column>& columns, TableWriter* table) const {
  const Json* items = value_at(results, path);
  if (!table || !items || !items->is_array()) return;
  for (const Json& item : *items) {
    std::vector<std::string> cells{id};
    for (const Column& one : columns) cells.push_back(cell_in(item, one));
    table->add(cells);
  }
}

void Tables::add(const CohortCase& one, const std::vector<std::string>& groups, const Json* results) {
  // Which columns there are is known from the schema of the first result; studies without one wait for it.
  if (results && !study_table_) open(groups, results->value("schema", ""));
  if (results && results->value("schema", "") != schema_)
    throw InputError(one.study.id + ": has results of another schema than the studies before it; expected " + schema_);
  std::vector<std::string> cells{one.study.id};
  cells.insert(cells.end(), one.study.groups.begin(), one.study.groups.end());
  const StudyStatus status = one.status.value_or(StudyStatus());
  std::string flags;
  for (const std::string& flag : one.flags) flags += (flags.empty() ? "" : " ") + flag;
  cells.insert(cells.end(),
               {!one.status   ? "not_run"
                : status.done ? "done"
                              : "failed",
                status.verdict, flags, status.reason, one.manual.decision, one.manual.reader, one.manual.comment});
  if (one.status)
    cells.insert(cells.end(), {std::to_string(status.attempts), status.started, fixed_text(status.wall_s),
                               fixed_text(status.cpu_s), fixed_text(status.peak_mb)});
  else
    cells.resize(cells.size() + 5);
  cells.insert(cells.end(), {status.input_sha256, status.settings,
                             results ? report_link(published_, cohort_, one.study.id) : std::string()});
  if (!study_table_) {
    before_.push_back(std::move(cells));
    return;
  }
  for (const Column& result : results_) cells.push_back(results ? cell_in(*results, result) : std::string());
  study_table_->add(cells);
  if (!results) return;
  add_list(one.study.id, *results, {"measures", "segments"}, segments_, segment_table_.get());
  add_list(one.study.id, *results, {"gates"}, gates_, curve_table_.get());
}

void Tables::write_dictionary() {
  const std::vector<Column> columns{column("table", CellType::text, ""), column("column", CellType::text, ""),
                                    column("type", CellType::text, ""), column("unit", CellType::text, ""),
                                    column("meaning", CellType::text, "")};
  TableWriter table(folder_ / "dictionary.tsv", database_, "dictionary", columns);
  for (const auto& [name, one] : dictionary_)
    table.add({name, one.name,
               one.type == CellType::real    ? "real"
               : one.type == CellType::whole ? "integer"
                                             : "text",
               one.unit, one.meaning});
  table.finish();
}

void Tables::finish(const std::vector<std::string>& groups, const std::vector<StatisticRow>& statistics) {
  if (!study_table_) open(groups, "dynasurf.ventricle/3");  // no study has a result
  study_table_->finish();
  if (segment_table_) segment_table_->finish();
  if (curve_table_) curve_table_->finish();
  write_dictionary();
  io::write_file(folder_ / "statistics.tsv", statistics_text(statistics));
  database_.finish();
}

CollectTally tally_of(const Cohort& cohort) {
  CollectTally tally;
  tally.studies = cohort.cases.size();
  for (const CohortCase& one : cohort.cases)
    ++(!one.status ? tally.not_run : one.has_result() ? tally.done : tally.failed);
  return tally;
}

/// The columns of groups, which the tables need before the first case is complete.
std::vector<std::string> groups_of(const fs::path& cohort) {
  return read_study_list(cohort / "inputs.tsv").group_columns;
}

}  // namespace

CollectTally collect(const std::filesystem::path& cohort, const std::filesystem::path& out,
                     const std::optional<std::filesystem::path>& other, bool replace) {
  const std::vector<std::string> groups = groups_of(cohort);
  io::OutputFolder folder(out, replace ? io::Existing::move_aside : io::Existing::replace);
  Tables tables(folder.path(), out, cohort);
  const Cohort read =
      read_cohort(cohort, [&](const CohortCase& one, const Json* results) { tables.add(one, groups, results); });
  std::vector<StatisticRow> statistics = statistics_of(read);
  if (other) {
    const Cohort second = read_cohort(*other, [](const CohortCase&, const Json*) {});
    const std::vector<StatisticRow> compared = comparison_of(read, second);
    statistics.insert(statistics.end(), compared.begin(), compared.end());
    io::write_file(folder.path() / "comparison.tsv", changes_text(read, second));
    write_cohort_page(read, statistics, &second, out, folder.path() / "cohort.html");
  } else {
    write_cohort_page(read, statistics, nullptr, out, folder.path() / "cohort.html");
  }
  tables.finish(groups, statistics);
  folder.publish();
  CollectTally tally = tally_of(read);
  tally.moved_to = folder.moved_to();
  return tally;
}

}  // namespace dynasurf::cohort
