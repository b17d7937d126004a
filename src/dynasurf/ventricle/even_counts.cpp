#include "dynasurf/ventricle/detail/even_counts.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/format.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double least_off = 0.05, most_factor = 3;
constexpr double beside_mm = 20;      // from the middle of the wall: beyond its blur
constexpr double least_beside = 0.1;  // of the counts
constexpr double alike = 0.04;        // shares of all counts and of those beside the heart
// Beats that were cut short leave less; a gate that lost more counts lost more than the end of some beats.
constexpr double least_usual = 0.85, most_usual = 1.15;  // those of the flag "counts_uneven"

/// Counts of one gate.
struct Counts {
  double all = 0, beside = 0;
};

std::vector<Counts> counts_of(const Study& study, const heart::LvShell& cup) {
  const Grid& grid = study.grid();
  std::vector<std::uint8_t> is_beside(grid.size());
  parallel_for(grid.dims[2], 1, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i)
          is_beside[grid.index(i, j, k)] = heart::signed_distance(cup, centre_of(grid, {i, j, k})) > beside_mm;
  });
  std::vector<Counts> counts(study.gates.size());
  parallel_for(counts.size(), 1, [&](std::size_t g, std::size_t) {
    const std::vector<float>& values = study.gates[g].values;
    for (std::size_t v = 0; v < values.size(); ++v) {
      counts[g].all += values[v];
      if (is_beside[v] != 0) counts[g].beside += values[v];
    }
  });
  return counts;
}

/// What each gate has of the counts of the usual one.
std::vector<double> shares(const std::vector<Counts>& counts, double Counts::*of) {
  std::vector<double> values;
  for (const Counts& c : counts) values.push_back(c.*of);
  const double usual = quantile(values, 0.5);
  for (double& v : values) v = usual > 0 ? v / usual : 0;
  return values;
}

}  // namespace

std::optional<Study> with_even_counts(const Study& study, const heart::Location& heart) {
  constexpr std::size_t least_gates = 4;
  const bool holds_counts = study.modality == "NM" || study.modality == "PT";
  if (!holds_counts || study.gates.size() < least_gates) return std::nullopt;
  const std::vector<Counts> counts = counts_of(study, to_grid(study.grid(), heart.cup));
  double all = 0, beside = 0;
  for (const Counts& c : counts) all += c.all, beside += c.beside;
  if (!(all > 0 && beside > least_beside * all)) return std::nullopt;
  const std::vector<double> of_all = shares(counts, &Counts::all), of_beside = shares(counts, &Counts::beside);
  std::optional<Study> even;
  for (std::size_t g = 0; g < counts.size(); ++g) {
    const double share = of_all[g];
    const bool is_off = std::abs(share - 1) > least_off && share > 1 / most_factor && share < most_factor;
    if (!is_off || std::abs(of_beside[g] / share - 1) > alike) continue;
    if (!even) even = study;
    for (float& v : even->gates[g].values) v /= share;
    const bool is_usual = share > least_usual && share < most_usual;
    even->notes.push_back(
        {is_usual ? Severity::info : Severity::warning, "study.counts_scaled",
         format("gate %zu holds %.0f %% of the counts of the others; it was brought to theirs", g + 1, 100 * share),
         static_cast<int>(g)});
  }
  return even;
}

}  // namespace dynasurf::ventricle
