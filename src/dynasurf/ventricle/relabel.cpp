#include "dynasurf/ventricle/detail/relabel.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/detail/visit_marked.hpp"
#include "dynasurf/heart/detail/smooth_cycle.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double most_stray_mm = 4;  // gates that lie farther do not bend the smooth course either

std::uint8_t bit_of(Border wall) { return wall == Border::endo ? Labels::endo_bit : Labels::epi_bit; }

std::optional<double> mean_radius_mm(const Labels& labels, Border wall, int base_slice) {
  const Grid& grid = labels.borders.grid;
  double sum = 0;
  int count = 0;
  const auto is_marked = [bit = bit_of(wall)](std::uint8_t voxel) { return (voxel & bit) != 0; };
  for (int k = 0; k < grid.dims[2] && (base_slice < 0 || k <= base_slice); ++k)
    visit_marked(labels.borders, k, is_marked, [&](int i, int j) {
      sum += own::hypot((i - labels.axis.x_at(k)) * grid.spacing[0], (j - labels.axis.y_at(k)) * grid.spacing[1]);
      ++count;
    });
  if (count == 0) return std::nullopt;
  return sum / count;
}

/// Squared distance in a slice to the nearest voxel with a bit, within a window.
double nearest(const Mask& borders, std::uint8_t bit, int i, int j, int k, int reach_i, int reach_j) {
  const Grid& grid = borders.grid;
  double best = 1e18;
  for (int b = std::max(0, j - reach_j); b <= std::min(grid.dims[1] - 1, j + reach_j); ++b)
    for (int a = std::max(0, i - reach_i); a <= std::min(grid.dims[0] - 1, i + reach_i); ++a)
      if ((borders(a, b, k) & bit) != 0)
        best = std::min(best, own::pow((a - i) * grid.spacing[0], 2) + own::pow((b - j) * grid.spacing[1], 2));
  return best;
}

}  // namespace

std::vector<std::optional<double>> strays_mm(std::span<const GateLabels> gates) {
  std::vector<std::optional<double>> strays(gates.size(), 0.0);
  for (const Border wall : {Border::endo, Border::epi}) {
    // Few waves, so that they do not bend towards a gate that strays.
    std::vector<std::optional<double>> radii;
    for (const GateLabels& gate : gates) radii.push_back(mean_radius_mm(*gate.labels, wall, gate.base_slice));
    const heart::SmoothCycle smooth = heart::smooth_over_cycle(radii, most_stray_mm, gates.size() >= 12 ? 2 : 1);
    for (std::size_t g = 0; g < gates.size(); ++g) {
      if (!radii[g]) strays[g] = std::nullopt;
      if (strays[g]) strays[g] = std::max(*strays[g], std::abs(*radii[g] - smooth.values[g]));
    }
  }
  return strays;
}

std::vector<Helpers> gates_to_help(std::span<const std::optional<double>> strays) {
  constexpr std::size_t least_gates = 6;
  const std::size_t n = strays.size();
  const auto is_stray = [&](std::size_t g) { return !strays[g] || *strays[g] > most_stray_mm; };
  std::vector<Helpers> all;
  for (std::size_t g = 0; g < n; ++g) {
    if (!is_stray(g)) continue;
    Helpers help{g, (g + n - 1) % n, (g + 1) % n, strays[g]};
    for (std::size_t step = 0; step < n && is_stray(help.before); ++step) help.before = (help.before + n - 1) % n;
    for (std::size_t step = 0; step < n && is_stray(help.after); ++step) help.after = (help.after + 1) % n;
    all.push_back(help);
  }
  if (n < least_gates || 3 * all.size() > n) return {};
  return all;
}

Labels relabel(const Mask& edges, const Labels& before, const Labels& after, double reach_mm) {
  Labels labels = before;
  labels.notes.clear();
  labels.local.clear();
  const Grid& grid = edges.grid;
  const int reach_i = reach_mm / grid.spacing[0], reach_j = reach_mm / grid.spacing[1];
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        labels.borders(i, j, k) = 0;
        if (edges(i, j, k) == 0) continue;
        const auto distance = [&](std::uint8_t bit) {
          return std::min(nearest(before.borders, bit, i, j, k, reach_i, reach_j),
                          nearest(after.borders, bit, i, j, k, reach_i, reach_j));
        };
        const double endo = distance(Labels::endo_bit), epi = distance(Labels::epi_bit);
        if (std::min(endo, epi) <= reach_mm * reach_mm)
          labels.borders(i, j, k) = endo < epi ? Labels::endo_bit : Labels::epi_bit;
      }
  return labels;
}

void share_division_slice(std::span<Labels* const> gates) {
  const auto is_guess = [](const Note& n) { return n.code == "slice_find.fallback" || n.code == "slice_find.no_rise"; };
  std::vector<Labels*> guessing;
  std::vector<int> seen;
  for (Labels* gate : gates)
    if (std::any_of(gate->notes.begin(), gate->notes.end(), is_guess))
      guessing.push_back(gate);
    else if (gate->division_slice >= 0)
      seen.push_back(gate->division_slice);
  if (guessing.empty() || seen.empty() || 3 * seen.size() < gates.size()) return;
  const int middle = upper_median(std::move(seen));
  for (Labels* gate : guessing) {
    if (gate->division_slice <= middle) continue;
    gate->division_slice = middle;
    std::erase_if(gate->notes, is_guess);
    gate->notes.push_back({Severity::info, "slice_find.shared",
                           "The end of the cavity is not seen in this gate; that of the others, slice " +
                               std::to_string(middle + 1) + ", was taken.",
                           -1, middle});
  }
}

}  // namespace dynasurf::ventricle
