#include "rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <sstream>

#include "dynasurf/core/error.hpp"
#include "dynasurf/report/detail/bland_altman.hpp"

namespace dynasurf {
namespace {

constexpr int first_reporting = 100;

struct Errors {
  std::vector<double> values;
  double mean() const {
    double sum = 0;
    for (const double v : values) sum += v;
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
  }
  double sd() const {
    double sum = 0;
    for (const double v : values) sum += (v - mean()) * (v - mean());
    return values.size() < 2 ? 0 : std::sqrt(sum / static_cast<double>(values.size() - 1));
  }
};

double percent_off(const Measured& r) { return 100 * (r.value / r.truth - 1); }
double points_off(const Measured& r) { return r.value - r.truth; }

double held(const std::vector<Row>& rows, const Measured Row::*reading) {
  constexpr double of_90_percent = 1.645;
  double count = 0;
  for (const Row& row : rows)
    if (std::abs(points_off(row.*reading)) <= of_90_percent * (row.*reading).sd) count += 1;
  return rows.empty() ? 0 : 100 * count / static_cast<double>(rows.size());
}

std::string mean_and_sd(const Errors& errors) {
  char text[40];
  std::snprintf(text, sizeof text, "%+.1f +- %.1f", errors.mean(), errors.sd());
  return text;
}

void print_row(const std::string& name, const std::vector<Row>& rows) {
  if (rows.empty()) return;
  Errors edv, esv, ef, wall, cycle, distance, edge, seconds;
  for (const Row& row : rows) {
    edv.values.push_back(percent_off(row.edv)), esv.values.push_back(percent_off(row.esv));
    ef.values.push_back(points_off(row.ef)), wall.values.push_back(percent_off(row.wall));
    cycle.values.push_back(row.wall_variation), distance.values.push_back(row.distance_mm);
    edge.values.push_back(100 * (row.edge_edv / row.edv.truth - 1)), seconds.values.push_back(row.seconds);
  }
  std::printf("| %s | %zu | %s | %s | %s | %s | %.1f | %.2f | %.0f / %.0f / %.0f | %s | %.1f |\n", name.c_str(),
              rows.size(), mean_and_sd(edv).c_str(), mean_and_sd(esv).c_str(), mean_and_sd(ef).c_str(),
              mean_and_sd(wall).c_str(), cycle.mean(), distance.mean(), held(rows, &Row::edv), held(rows, &Row::esv),
              held(rows, &Row::ef), mean_and_sd(edge).c_str(), seconds.mean());
}

std::vector<Row> chosen(const std::vector<Row>& rows, const std::function<bool(const Row&)>& is_chosen) {
  std::vector<Row> some;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(some), is_chosen);
  return some;
}

/// How well the data tell the width of the point spread.
void print_widths(const std::vector<Row>& rows) {
  constexpr double step_mm = 2, first_mm = 8, end_mm = 16;
  std::printf("\n| FWHM mm | n | told %% | read %% | held %% |\n|---|---|---|---|---|\n");
  const auto print_class = [&](double low, double high) {
    const std::vector<Row> some =
        chosen(rows, [&](const Row& r) { return r.fwhm.value > 0 && r.fwhm.truth >= low && r.fwhm.truth < high; });
    Errors told, read;
    for (const Row& row : some) {
      if (row.told_mm > 0) told.values.push_back(100 * (row.told_mm / row.fwhm.truth - 1));
      read.values.push_back(percent_off(row.fwhm));
    }
    if (some.empty()) return;
    std::printf("| %.0f to %.0f | %zu | %s | %s | %.0f |\n", low, high, some.size(),
                told.values.empty() ? "-" : mean_and_sd(told).c_str(), mean_and_sd(read).c_str(),
                held(some, &Row::fwhm));
  };
  for (double low = first_mm; low < end_mm; low += step_mm) print_class(low, low + step_mm);
  print_class(first_mm, end_mm);
}

/// How often the intervals hold the truth in patients of both kinds together.
void print_held_of_both(const std::vector<Row>& all, bool reporting) {
  const std::vector<Row> rows = chosen(all, [&](const Row& r) {
    return r.generator != "untold" && (r.number >= first_reporting) == reporting && r.edv.value > 0;
  });
  if (rows.empty()) return;
  std::printf("\nplain and unlike together, %s half: held %% EDV / ESV / EF / wall %.0f / %.0f / %.0f / %.0f\n",
              reporting ? "reporting" : "choosing", held(rows, &Row::edv), held(rows, &Row::esv), held(rows, &Row::ef),
              held(rows, &Row::wall));
}

/// The differences of one number, grouped by what was planted in the patients.
void draw_agreement(const std::vector<Row>& rows, const Measured Row::*reading, const report::AgreementPlot& plot,
                    const std::string& file) {
  std::vector<report::ReadingGroup> groups{{"neither", {}}, {"gut beside", {}}, {"defect", {}}};
  for (const Row& row : rows)
    groups[row.has_defect ? 2 : row.has_gut ? 1 : 0].readings.push_back({(row.*reading).truth, (row.*reading).value});
  std::ofstream(file) << report::bland_altman_svg(groups, plot);
}

}  // namespace

std::string line_of(const Row& r) {
  std::ostringstream line;
  line.precision(5);
  line << r.generator << ' ' << r.number << ' ' << r.has_defect << ' ' << r.has_gut << ' ' << r.told_mm;
  for (const Measured* reading : {&r.fwhm, &r.edv, &r.esv, &r.ef, &r.wall})
    line << ' ' << reading->truth << ' ' << reading->value << ' ' << reading->sd;
  line << ' ' << r.wall_variation << ' ' << r.distance_mm << ' ' << r.edge_edv << ' ' << r.edge_ef << ' ' << r.seconds;
  return line.str();
}

std::vector<Row> read_rows(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw IoError(file + ": cannot be read; expected the rows of a run");
  std::vector<Row> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    Row r;
    words >> r.generator >> r.number >> r.has_defect >> r.has_gut >> r.told_mm;
    for (Measured* reading : {&r.fwhm, &r.edv, &r.esv, &r.ef, &r.wall})
      words >> reading->truth >> reading->value >> reading->sd;
    words >> r.wall_variation >> r.distance_mm >> r.edge_edv >> r.edge_ef >> r.seconds;
    if (!words) throw InputError(file + ", line " + std::to_string(rows.size() + 1) + ": not a row of a run");
    rows.push_back(r);
  }
  return rows;
}

void print_tables(const std::vector<Row>& all, const std::string& folder) {
  for (const std::string generator : {"plain", "unlike", "untold"})
    for (const bool reporting : {false, true}) {
      const std::vector<Row> half = chosen(
          all, [&](const Row& r) { return r.generator == generator && (r.number >= first_reporting) == reporting; });
      if (half.empty()) continue;
      const std::vector<Row> rows = chosen(half, [](const Row& r) { return r.edv.value > 0; });
      std::printf("\n%s, %s half (%zu of %zu with surfaces)\n\n", generator.c_str(),
                  reporting ? "reporting" : "choosing", rows.size(), half.size());
      std::printf(
          "| patients | n | EDV %% | ESV %% | EF points | wall %% | over the beat %% | distance mm | held %% EDV / ESV "
          "/ EF | "
          "classic edge EDV %% | s |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
      const auto is_small = [](const Row& r) { return r.edv.truth < 60; };
      print_row("all", rows);
      print_row("60 mL and more, no defect", chosen(rows, [&](const Row& r) { return !is_small(r) && !r.has_defect; }));
      print_row("nothing beside, no defect", chosen(rows, [&](const Row& r) { return !r.has_gut && !r.has_defect; }));
      print_row("with a defect", chosen(rows, [](const Row& r) { return r.has_defect != 0; }));
      print_row("with gut", chosen(rows, [](const Row& r) { return r.has_gut != 0; }));
      print_row("below 60 mL", chosen(rows, is_small));
      print_widths(rows);
      if (!reporting) continue;
      const std::string to = folder + "/" + generator;
      draw_agreement(rows, &Row::edv, {"EDV, " + generator, "mL", false}, to + "_edv.svg");
      draw_agreement(rows, &Row::esv, {"ESV, " + generator, "mL", false}, to + "_esv.svg");
      draw_agreement(rows, &Row::ef, {"EF, " + generator, "%", false}, to + "_ef.svg");
    }
  for (const bool reporting : {false, true}) print_held_of_both(all, reporting);
}

}  // namespace dynasurf
