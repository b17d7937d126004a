#include "dynasurf/ventricle/measures/normal_limits.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "dynasurf/core/error.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double segment_limit_sd = 2.5;

void require_size(std::size_t found, std::size_t expected, const char* what) {
  if (found != expected)
    throw InputError(std::string(what) + " has " + std::to_string(found) + " samples; expected " +
                     std::to_string(expected));
}

int score_of(double percent) {
  int score = 0;
  // Every cut that is not reached adds a point, up to 4.
  for (const double cut : {70.0, 60.0, 50.0, 30.0}) score += percent < cut;
  return score;
}

void add_up(SegmentScores& scores) {
  scores.sum = scores.most = 0;
  for (const auto& s : scores.score)
    if (s) scores.sum += *s, scores.most += 4;
}

}  // namespace

NormalMap build_normal_map(std::span<const PolarValues> perfusion, const PolarGrid& grid, double least_sd) {
  if (perfusion.size() < 3) throw InputError(std::to_string(perfusion.size()) + " normal studies; expected at least 3");
  NormalMap normal;
  normal.grid = grid, normal.studies = perfusion.size();
  normal.mean.resize(grid.size()), normal.sd.resize(grid.size());
  for (const PolarValues& map : perfusion) require_size(map.size(), grid.size(), "a map of a normal study");
  for (std::size_t n = 0; n < grid.size(); ++n) {
    double sum = 0, squares = 0;
    int count = 0;
    for (const PolarValues& map : perfusion)
      if (map[n]) sum += *map[n], ++count;
    if (count < 3) continue;
    const double mean = sum / count;
    for (const PolarValues& map : perfusion)
      if (map[n]) squares += (*map[n] - mean) * (*map[n] - mean);
    normal.mean[n] = mean;
    normal.sd[n] = std::max(least_sd, std::sqrt(squares / (count - 1)));
  }
  return normal;
}

std::optional<DefectMeasures> measure_defect(const PolarValues& perfusion, std::span<const double> area,
                                             const NormalMap& normal, double limit_sd) {
  require_size(perfusion.size(), normal.grid.size(), "the map");
  require_size(area.size(), normal.grid.size(), "the list of areas");
  DefectMeasures defect;
  double all = 0, sick = 0, depth = 0, lack = 0;
  for (std::size_t n = 0; n < perfusion.size(); ++n) {
    if (!perfusion[n] || !normal.mean[n] || !(*normal.mean[n] > 0)) continue;
    all += area[n];
    const double below = (*normal.mean[n] - *perfusion[n]) / *normal.sd[n];
    if (below <= limit_sd) continue;
    sick += area[n], depth += area[n] * below;
    // The share of normal uptake that is missing: 0 as normal, 1 without uptake.
    lack += area[n] * std::clamp(1 - *perfusion[n] / *normal.mean[n], 0.0, 1.0);
  }
  if (!(all > 0)) return std::nullopt;
  defect.extent_percent = 100 * sick / all;
  defect.severity_sd = sick > 0 ? depth / sick : 0;
  defect.deficit_percent = 100 * lack / all;
  return defect;
}

SegmentScores score_segments(SegmentModel model, const PolarGrid& grid, const PolarValues& perfusion,
                             const std::vector<double>& area, const NormalMap* normal) {
  require_size(perfusion.size(), grid.size(), "the map");
  require_size(area.size(), grid.size(), "the list of areas");
  const PolarValues found = segment_means(model, grid, perfusion, area);
  PolarValues mean(found.size()), sd(found.size());
  if (normal) {
    require_size(normal->grid.size(), grid.size(), "the normal map");
    mean = segment_means(model, grid, normal->mean, area);
    // Neighbouring samples go up and down together, so their mean deviation is that of the segment.
    sd = segment_means(model, grid, normal->sd, area);
  }
  SegmentScores scores;
  scores.score.resize(found.size());
  scores.by_hand.assign(found.size(), false);
  for (std::size_t s = 0; s < found.size(); ++s) {
    if (!found[s] || (normal && !(mean[s] && *mean[s] > 0))) continue;
    int score = score_of(normal ? 100 * *found[s] / *mean[s] : *found[s]);
    if (normal && (*mean[s] - *found[s]) / *sd[s] > segment_limit_sd) score = std::max(score, 1);
    scores.score[s] = score;
  }
  add_up(scores);
  return scores;
}

void set_score(SegmentScores& scores, int segment, int score) {
  if (segment < 1 || segment > std::ssize(scores.score))
    throw InputError("segment " + std::to_string(segment) + "; expected 1 to " + std::to_string(scores.score.size()));
  if (score < 0 || score > 4)
    throw InputError("score " + std::to_string(score) + " of segment " + std::to_string(segment) + "; expected 0 to 4");
  scores.score[segment - 1] = score;
  scores.by_hand[segment - 1] = true;
  add_up(scores);
}

}  // namespace dynasurf::ventricle
