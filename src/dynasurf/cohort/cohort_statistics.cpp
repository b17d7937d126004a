#include "dynasurf/cohort/detail/cohort_statistics.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

namespace dynasurf::cohort {
namespace {

/// Columns of more values, such as ages or names, make no groups.
constexpr std::size_t most_groups = 6;
constexpr double absent = std::numeric_limits<double>::quiet_NaN();

using Rows = std::vector<StatisticRow>;

/// A result that is not trustworthy counts as none: its numbers may be of anything.
bool counts(const CohortCase& one) { return one.has_result() && one.status->verdict != "fail"; }

double number_of(const CohortCase& one, std::size_t key) {
  return counts(one) && key < one.numbers.size() ? one.numbers[key].value_or(absent) : absent;
}

double number_in(const std::string& text) {
  double value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && rest == text.data() + text.size() && !text.empty() ? value : absent;
}

void add_summary(const KeyNumber& key, const std::string& group, const std::vector<double>& values, Rows& rows) {
  const SampleSummary summary = summarize(values);
  if (summary.n == 0) return;
  rows.push_back({"mean", key.name, "", group, summary.n, summary.left_out, summary.mean});
  if (summary.sd) rows.push_back({"sd", key.name, "", group, summary.n, summary.left_out, {*summary.sd, {}, {}}});
}

void add_agreement(const std::string& of, const std::string& against, const std::vector<ValuePair>& pairs, Rows& rows) {
  const auto limits = limits_of_agreement(pairs);
  if (!limits) return;
  const std::size_t n = limits->n, out = limits->left_out;
  rows.push_back({"bias", of, against, "", n, out, limits->bias});
  rows.push_back({"sd_of_differences", of, against, "", n, out, {limits->sd, {}, {}}});
  rows.push_back({"limit_low", of, against, "", n, out, limits->low});
  rows.push_back({"limit_high", of, against, "", n, out, limits->high});
  std::vector<std::vector<double>> readings;
  readings.reserve(pairs.size());
  for (const ValuePair& pair : pairs) readings.push_back({pair.first, pair.second});
  if (const auto icc = icc_absolute(readings))
    rows.push_back({"icc_absolute", of, against, "", icc->n, icc->left_out, icc->value});
}

/// "ef_percent" for the column ef_true_percent.
std::string without_true(std::string column) {
  const std::size_t at = column.find("_true_");
  return at == std::string::npos ? std::string() : column.replace(at, 6, "_");
}

/// The share of each verdict, and of runs without a result, among the studies that were run; in all and in each group
/// of a column of two to six values.
void add_outcomes(const Cohort& cohort, Rows& rows) {
  const auto add = [&](const std::string& group, const std::function<bool(const CohortCase&)>& belongs) {
    std::map<std::string, std::size_t> outcomes{{"ok", 0}, {"check", 0}, {"fail", 0}, {"no result", 0}};
    std::size_t n = 0, left_out = 0;
    for (const CohortCase& one : cohort.cases) {
      if (!belongs(one)) continue;
      if (!one.status) {
        ++left_out;
        continue;
      }
      ++n;
      ++outcomes[one.status->done ? one.status->verdict : "no result"];
    }
    if (n == 0) return;
    for (const auto& [outcome, cases] : outcomes)
      rows.push_back({"share", "verdict=" + outcome, "", group, n, left_out, share_of_cases(cases, n)});
  };
  add("", [](const CohortCase&) { return true; });
  for (std::size_t column = 0; column < cohort.group_columns.size(); ++column) {
    std::set<std::string> values;
    for (const CohortCase& one : cohort.cases) values.insert(one.study.groups[column]);
    values.erase("");
    if (values.size() < 2 || values.size() > most_groups || !without_true(cohort.group_columns[column]).empty())
      continue;
    for (const std::string& value : values)
      add(cohort.group_columns[column] + "=" + value,
          [&](const CohortCase& one) { return one.study.groups[column] == value; });
  }
}

/// The values of a key number in each group of a column, where it has two to six values.
std::map<std::string, std::vector<double>> by_group(const Cohort& cohort, std::size_t column, std::size_t key) {
  std::map<std::string, std::vector<double>> groups;
  for (const CohortCase& one : cohort.cases)
    if (const std::string& group = one.study.groups[column]; !group.empty())
      groups[group].push_back(number_of(one, key));
  return groups.size() >= 2 && groups.size() <= most_groups ? groups : std::map<std::string, std::vector<double>>();
}

void add_groups(const Cohort& cohort, std::size_t column, std::size_t key, Rows& rows) {
  const KeyNumber& number = ventricle_key_numbers()[key];
  const std::string name = cohort.group_columns[column] + "=";
  const auto groups = by_group(cohort, column, key);
  for (const auto& [group, values] : groups) add_summary(number, name + group, values, rows);
  for (auto a = groups.begin(); a != groups.end(); ++a)
    for (auto b = std::next(a); b != groups.end(); ++b) {
      const auto difference = compare_groups(a->second, b->second);
      if (!difference) continue;
      const std::string both = name + a->first + " less " + b->first;
      const std::size_t n = difference->first_n + difference->second_n, out = difference->left_out;
      rows.push_back({"difference", number.name, "", both, n, out, difference->difference});
      rows.push_back({"hedges_g", number.name, "", both, n, out, difference->hedges_g});
      rows.push_back({"welch_p", number.name, "", both, n, out, {difference->p, {}, {}}});
    }
}

void add_truth(const Cohort& cohort, Rows& rows) {
  const auto& keys = ventricle_key_numbers();
  for (std::size_t column = 0; column < cohort.group_columns.size(); ++column)
    for (std::size_t key = 0; key < keys.size(); ++key) {
      if (keys[key].path.back() != without_true(cohort.group_columns[column])) continue;
      std::vector<ValuePair> pairs;
      for (const CohortCase& one : cohort.cases)
        pairs.push_back({number_in(one.study.groups[column]), number_of(one, key)});
      add_agreement(keys[key].name, cohort.group_columns[column], pairs, rows);
    }
}

/// The leading reading against the edges', and the profile's.
void add_readings(const Cohort& cohort, Rows& rows) {
  const auto& keys = ventricle_key_numbers();
  for (std::size_t a = 0; a < keys.size(); ++a)
    for (std::size_t b = 0; b < keys.size(); ++b) {
      if (keys[a].path.size() != 1 || keys[b].path.front() != "readings" || keys[b].path.back() != keys[a].name)
        continue;
      std::vector<ValuePair> pairs;
      for (const CohortCase& one : cohort.cases) pairs.push_back({number_of(one, a), number_of(one, b)});
      add_agreement(keys[b].name, keys[a].name, pairs, rows);
    }
}

void add_repeats(const Cohort& cohort, Rows& rows) {
  const auto& columns = cohort.group_columns;
  const auto subject = std::find(columns.begin(), columns.end(), "subject");
  if (subject == columns.end()) return;
  const std::size_t column = subject - columns.begin();
  for (std::size_t key = 0; key < ventricle_key_numbers().size(); ++key) {
    std::map<std::string, std::vector<double>> by_subject;
    for (const CohortCase& one : cohort.cases) by_subject[one.study.groups[column]].push_back(number_of(one, key));
    std::vector<std::vector<double>> repeats;
    repeats.reserve(by_subject.size());
    for (const auto& [name, values] : by_subject) repeats.push_back(values);
    const auto result = repeatability(repeats);
    if (!result) continue;
    const std::string& name = ventricle_key_numbers()[key].name;
    rows.push_back({"within_subject_sd", name, "", "", result->subjects, result->left_out, result->within_sd});
    rows.push_back(
        {"repeatability_coefficient", name, "", "", result->subjects, result->left_out, result->coefficient});
  }
}

std::string text_of(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return "";
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, *value).ptr};
}

std::map<std::string, const CohortCase*> by_id(const Cohort& cohort) {
  std::map<std::string, const CohortCase*> cases;
  for (const CohortCase& one : cohort.cases) cases[one.study.id] = &one;
  return cases;
}

std::string reason_of_change(const CohortCase* a, const CohortCase* b, bool differs) {
  if (!a || !b || !a->status || !b->status) return "one is missing";
  if (a->status->done != b->status->done) return "one failed";
  if (a->status->input_sha256 != b->status->input_sha256) return "input";
  if (a->status->settings != b->status->settings) return differs ? "settings" : "";
  return differs ? "same bytes in, other numbers out" : "";
}

}  // namespace

std::vector<StatisticRow> statistics_of(const Cohort& cohort) {
  Rows rows;
  for (std::size_t key = 0; key < ventricle_key_numbers().size(); ++key) {
    std::vector<double> values;
    for (const CohortCase& one : cohort.cases) values.push_back(number_of(one, key));
    add_summary(ventricle_key_numbers()[key], "", values, rows);
    for (std::size_t column = 0; column < cohort.group_columns.size(); ++column)
      if (without_true(cohort.group_columns[column]).empty()) add_groups(cohort, column, key, rows);
  }
  add_outcomes(cohort, rows);
  add_truth(cohort, rows);
  add_readings(cohort, rows);
  add_repeats(cohort, rows);
  return rows;
}

std::vector<StatisticRow> comparison_of(const Cohort& first, const Cohort& second) {
  Rows rows;
  const auto others = by_id(second);
  for (std::size_t key = 0; key < ventricle_key_numbers().size(); ++key) {
    std::vector<ValuePair> pairs;
    for (const CohortCase& one : first.cases) {
      const auto other = others.find(one.study.id);
      pairs.push_back({number_of(one, key), other == others.end() ? absent : number_of(*other->second, key)});
    }
    add_agreement(ventricle_key_numbers()[key].name, "the same in the other cohort", pairs, rows);
  }
  return rows;
}

std::string statistics_text(const std::vector<StatisticRow>& rows) {
  std::string text = "statistic\tof\tagainst\tgroup\tn\tleft_out\tvalue\tlow_95\thigh_95\n";
  for (const StatisticRow& row : rows)
    text += row.statistic + "\t" + row.of + "\t" + row.against + "\t" + row.group + "\t" + std::to_string(row.n) +
            "\t" + std::to_string(row.left_out) + "\t" + text_of(row.value.value) + "\t" + text_of(row.value.low) +
            "\t" + text_of(row.value.high) + "\n";
  return text;
}

std::string changes_text(const Cohort& first, const Cohort& second) {
  constexpr std::size_t compared[] = {0, 1, 2, 4};  // EF, EDV, ESV, wall
  const auto a = by_id(first), b = by_id(second);
  std::set<std::string> ids;
  for (const auto* cases : {&a, &b})
    for (const auto& [id, one] : *cases) ids.insert(id);
  std::vector<std::pair<double, std::string>> lines;
  for (const std::string& id : ids) {
    const CohortCase* one = a.contains(id) ? a.at(id) : nullptr;
    const CohortCase* other = b.contains(id) ? b.at(id) : nullptr;
    const auto verdict = [](const CohortCase* c) { return c && c->status ? c->status->verdict : std::string(); };
    std::string cells;
    double change = 0;
    bool differs = verdict(one) != verdict(other);
    for (const std::size_t key : compared) {
      const auto value = [&](const CohortCase* c) {
        return c && key < c->numbers.size() ? c->numbers[key] : std::nullopt;
      };
      const auto x = value(one), y = value(other);
      const auto difference = x && y ? std::optional(*y - *x) : std::nullopt;
      differs |= x != y;
      // Sorted by the change of EF: a study that has it in one cohort only stands before all others.
      if (key == 0) change = difference ? std::abs(*difference) : std::numeric_limits<double>::infinity();
      cells += "\t" + text_of(x) + "\t" + text_of(y) + "\t" + text_of(difference);
    }
    // Negative, so that sorting puts the largest first and equal ones by their ids.
    lines.emplace_back(-change, id + "\t" + reason_of_change(one, other, differs) + "\t" + verdict(one) + "\t" +
                                    verdict(other) + cells + "\n");
  }
  std::sort(lines.begin(), lines.end());
  std::string text = "id\twhy\tverdict_first\tverdict_second";
  for (const std::size_t key : compared) {
    const std::string& name = ventricle_key_numbers()[key].name;
    text += "\t" + name + "_first\t" + name + "_second\t" + name + "_change";
  }
  text += "\n";
  for (const auto& [change, line] : lines) text += line;
  return text;
}

}  // namespace dynasurf::cohort
