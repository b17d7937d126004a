// regional_truth FIRST END: virtual patients with regional differences; every segment's numbers, classic and unbiased,
// against the true ones. One line per patient, then tables over all.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "../../app/true_walls.hpp"

namespace dynasurf {
namespace {

struct Case {
  std::string name;
  synthetic::VirtualPatient options;
};

/// The patient of a number: kinds go round, sizes, blur and noise change with every round.
Case case_of(int number) {
  constexpr int kinds = 10;
  const int round = number / kinds;
  synthetic::VirtualPatient o;
  o.edv_ml = 95 + 30 * (round % 3), o.ef_percent = 60 - 7 * (round % 2), o.wall_ml = 70 + 0.4 * o.edv_ml;
  o.fwhm_mm = 10 + 2 * (round % 2);
  o.gates = round % 2 ? 16 : 8;
  o.pose.tilt_deg = 4, o.pose.tilt_towards_deg = 40.0 * (number % 9);
  o.lattice = {40, 40, 32, 4.3, 4.3, 4.3};
  o.noise.seed = 500 + static_cast<std::uint64_t>(number);
  const auto defect = [&](synthetic::Defect place, double severity) {
    o.defect = place, o.defect_severity = severity, o.defect_extent_deg = 70 + 10 * (round % 3);
  };
  const auto late = [&](synthetic::Defect place, double percent) {
    o.late_wall = place, o.delay_percent = percent, o.late_extent_deg = 120;
  };
  std::string name;
  switch (number % kinds) {
    case 0:
      name = "healthy";
      break;
    case 1:
      name = "inferior 40 %", defect(synthetic::Defect::inferior, 0.4);
      break;
    case 2:
      name = "lateral 85 %", defect(synthetic::Defect::lateral, 0.85);
      break;
    case 3:
      name = "apical 40 %", defect(synthetic::Defect::apical, 0.4);
      break;
    case 4:
      name = "anteroapical 85 %", defect(synthetic::Defect::anteroapical, 0.85);
      break;
    case 5:
      name = "septal 60 %", defect(synthetic::Defect::septal, 0.6);
      break;
    case 6:
      name = "lateral late 10 %", late(synthetic::Defect::lateral, 10);
      break;
    case 7:
      name = "septal late 20 %", late(synthetic::Defect::septal, 20);
      break;
    case 8:
      name = "uneven walls", o.irregular.walls = 1;
      break;
    default:
      name = "thin, dilated", o.edv_ml = 220 + 20 * (round % 2), o.ef_percent = 30, o.wall_ml = 110;
      break;
  }
  return {name, o};
}

/// One number of a segment, how large an error still counts as right, and how its error is told.
struct Quantity {
  std::string name;
  std::optional<double> ventricle::SegmentMeasures::*read, ventricle::SegmentMeasures::*truth;
  std::optional<double> ventricle::SegmentErrors::*sd;  // null: never told
  double least;  // errors up to this much are right whatever the truth is: one bin
  bool cyclic = false;
};
using S = ventricle::SegmentMeasures;
const std::vector<Quantity> quantities{
    {"perfusion, %", &S::perfusion_percent, &S::perfusion_percent, &ventricle::SegmentErrors::perfusion_percent, 10},
    {"thickness ED, mm", &S::thickness_ed_mm, &S::thickness_ed_mm, &ventricle::SegmentErrors::thickness_ed_mm, 1},
    {"thickness ES, mm", &S::thickness_es_mm, &S::thickness_es_mm, &ventricle::SegmentErrors::thickness_es_mm, 1},
    {"thickening, %", &S::thickening_percent, &S::thickening_percent, &ventricle::SegmentErrors::thickening_percent,
     10},
    {"thickening by counts, %", &S::count_thickening_percent, &S::thickening_percent, nullptr, 10},
    {"inward motion, mm", &S::motion_mm, &S::motion_mm, &ventricle::SegmentErrors::motion_mm, 1},
    {"onset by counts, deg", &S::phase_counts_deg, &S::phase_thickness_deg, nullptr, 6, true},
    {"onset by thickness, deg", &S::phase_thickness_deg, &S::phase_thickness_deg,
     &ventricle::SegmentErrors::phase_thickness_deg, 6, true},
    {"onset by motion, deg", &S::phase_motion_deg, &S::phase_motion_deg, &ventricle::SegmentErrors::phase_motion_deg, 6,
     true},
};

struct Sums {
  int n = 0, right = 0, told = 0, held = 0;
  double sum = 0, squares = 0, told_squares = 0;  // of errors; of errors over their standard deviations
  void add(double error, bool is_right, const std::optional<double>& sd = {}) {
    ++n, right += is_right, sum += error, squares += error * error;
    if (!sd) return;
    ++told, held += std::abs(error) <= 1.645 * *sd, told_squares += error * error / (*sd * *sd);
  }
  double mean() const { return n ? sum / n : 0; }
  double sd() const { return n > 1 ? std::sqrt(std::max(0.0, (squares - n * mean() * mean()) / (n - 1))) : 0; }
};

using Table = std::map<std::string, std::map<std::string, Sums>>;  // [quantity][reading]

bool is_right(double error, double truth, double least) {
  return std::abs(error) <= std::max(least, 0.1 * std::abs(truth));
}

void compare(const ventricle::Measures& read, const ventricle::Measures& truth, const std::string& reading,
             Table& table) {
  for (std::size_t s = 0; s < truth.segments.size() && s < read.segments.size(); ++s)
    for (const Quantity& q : quantities) {
      const auto &value = read.segments[s].*q.read, &expected = truth.segments[s].*q.truth;
      if (!value || !expected) continue;
      const double error = q.cyclic ? std::remainder(*value - *expected, 360.0) : *value - *expected;
      table[q.name][reading].add(error, is_right(error, q.cyclic ? 0 : *expected, q.least),
                                 q.sd ? read.segments[s].sd.*q.sd : std::nullopt);
    }
  const auto spread = [&](const char* name, const std::optional<ventricle::PhaseSummary>& value,
                          const std::optional<ventricle::PhaseSummary>& expected) {
    if (!value || !expected) return;
    const double error = value->sd_deg - expected->sd_deg;
    table[name][reading].add(error, is_right(error, expected->sd_deg, 6), value->sd_error_deg);
  };
  spread("SD of the onset by counts, deg", read.phase_counts, truth.phase_thickness);
  spread("SD of the onset by thickness, deg", read.phase_thickness, truth.phase_thickness);
  spread("SD of the onset by motion, deg", read.phase_motion, truth.phase_motion);
}

void print(const std::string& title, const Table& table) {
  std::printf(
      "\n%s\n\n| number | n | classic edge | right %% | unbiased | right %% | told, held %%, "
      "error over its deviation |\n|---|---|---|---|---|---|---|\n",
      title.c_str());
  for (const auto& [name, readings] : table) {
    const auto cell = [&](const char* reading) {
      char text[64] = "- | -";
      const auto at = readings.find(reading);
      if (at != readings.end() && at->second.n > 0)
        std::snprintf(text, sizeof text, "%+.1f +- %.1f | %.0f", at->second.mean(), at->second.sd(),
                      100.0 * at->second.right / at->second.n);
      return std::string(text);
    };
    char held[64] = "-";
    if (const auto at = readings.find("fit"); at != readings.end() && at->second.told > 0) {
      const Sums& s = at->second;
      std::snprintf(held, sizeof held, "%d, %.0f, %.1f", s.told, 100.0 * s.held / s.told,
                    std::sqrt(s.told_squares / s.told));
    }
    std::printf("| %s | %d | %s | %s | %s |\n", name.c_str(), readings.begin()->second.n, cell("edge").c_str(),
                cell("fit").c_str(), held);
  }
}

void run(int first, int end) {
  Table all;
  std::map<std::string, Table> of_kind;
  for (int number = first; number < end; ++number) {
    const Case one = case_of(number);
    const synthetic::Phantom phantom = synthetic::make_phantom(one.options);
    const ventricle::Measures truth = measure_true_walls(phantom);
    for (const char* preset : {"edges", "psf_corrected"}) {
      ventricle::Options options = ventricle::preset(preset);
      options.fit.fwhm_mm = one.options.fwhm_mm;
      options.fit.filter_fwhm_mm = one.options.noise.filter_fwhm_mm;
      const ventricle::Result result = ventricle::reconstruct(phantom.study, options);
      const bool is_fit = result.readings.psf_corrected.has_value();
      std::printf("%d %s %s EF %.1f (true %.1f)\n", number, one.name.c_str(), is_fit ? "psf_corrected" : "edge",
                  result.leading.ef_percent.value_or(heart::Estimate{}).value, *phantom.ef_percent);
      if (is_fit)
        std::printf("  thickness from data %.2f, width from data %.2f\n",
                    result.readings.psf_corrected->thickness_from_data, result.readings.psf_corrected->width_from_data);
      if (!result.measures) continue;
      for (Table* table : {&all, &of_kind[one.name]}) compare(*result.measures, truth, is_fit ? "fit" : "edge", *table);
    }
    std::fflush(stdout);
  }
  print("All", all);
  for (const auto& [name, table] : of_kind) print(name, table);
}

}  // namespace
}  // namespace dynasurf

int main(int count, char** words) try {
  if (count != 3) {
    std::fprintf(stderr, "expected: FIRST END\n");
    return 1;
  }
  dynasurf::run(std::atoi(words[1]), std::atoi(words[2]));
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
