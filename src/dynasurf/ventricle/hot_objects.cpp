#include "dynasurf/ventricle/detail/hot_objects.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/ventricle/detail/canonical.hpp"

namespace dynasurf::ventricle {
namespace {

/// Of the bright part of the wall in the mean of the gates. The brightest voxel of a wall at end-systole, with its
/// noise, has up to 1.6 times of it.
constexpr double brightest_wall = 2.5, cut_at = 2;

/// The brightness that four fifths of the wall stay below: neither a large defect nor a neighbour moves it far.
double bright_wall(const Image& mean, const heart::LvShell& cup) {
  constexpr double share = 0.8, reach_mm = 8;
  std::vector<double> values;
  for (const heart::RidgePoint& p : heart::find_ridge(mean, cup, 6, 16, reach_mm)) values.push_back(p.brightness);
  const std::size_t rank = share * values.size();
  return of_rank(std::move(values), rank);
}

}  // namespace

std::optional<Study> cut_hot_objects(const Study& study, const heart::Location& heart) {
  if (!heart.is_believed()) return std::nullopt;
  const Image mean = heart::mean_image(study.gates);
  const double wall = bright_wall(mean, to_grid(mean.grid, heart.cup));
  const float peak = peak_of(study.gates);
  if (!(wall > 0) || peak <= brightest_wall * wall) return std::nullopt;
  Study cut = study;
  const float most = cut_at * wall;
  for (Image& gate : cut.gates)
    for (float& value : gate.values) value = std::min(value, most);
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "something in the volume is %.1f times as bright as the heart's wall; for the edges it was cut to "
                "%.0f times",
                peak / wall, cut_at);
  cut.notes.push_back({Severity::info, "study.hot_cut", text.data()});
  return cut;
}

}  // namespace dynasurf::ventricle
