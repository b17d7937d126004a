#pragma once
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/ventricle/measures/detail/wall_map.hpp"

namespace dynasurf::ventricle {

/// Perfusion of normal hearts, sample by sample, as `PolarMaps::perfusion_percent`.
struct NormalMap {
  PolarGrid grid;
  Perfusion perfusion_is = Perfusion::none;
  int studies = 0;
  PolarValues mean, sd;  // absent where fewer than 3 studies have a value
};

/// Mean and standard deviation (n - 1) of the maps. A deviation below `least_sd` is raised to it: a handful of studies
/// may agree by chance. What the maps are made of is for the caller to tell. Throws InputError for fewer than 3 maps or
/// maps of different sizes.
NormalMap build_normal_map(std::span<const PolarValues> perfusion, const PolarGrid& grid, double least_sd = 4);

/// What of a wall lies below normal.
struct DefectMeasures {
  double extent_percent = 0;   // share of the wall's area more than `limit_sd` deviations below the normal mean
  double severity_sd = 0;      // mean depth there, in deviations below the mean; 0 without a defect
  double deficit_percent = 0;  // mean over the whole wall of what such places lack of the normal mean: 100 is no uptake
};
/// Samples that have no value or no normal take no part. Absent when none does. Throws InputError when the sizes
/// differ.
std::optional<DefectMeasures> measure_defect(const PolarValues& perfusion, std::span<const double> area,
                                             const NormalMap& normal, double limit_sd = 2.5);

/// Scores of segments: 0 normal, 1 mild, 2 moderate, 3 severe, 4 no uptake.
struct SegmentScores {
  std::vector<std::optional<int>> score;  // by number
  std::vector<bool> by_hand;              // set by a person
  int sum = 0, most = 0;                  // of the scores there are, and the largest sum they could have
  double percent() const { return most > 0 ? 100.0 * sum / most : 0; }
};

/// Scores by uptake: 70 % and more is 0, 60 to 70 is 1, 50 to 60 is 2, 30 to 50 is 3, less is 4; cuts of ours, programs
/// differ. With a normal map the uptake is taken in percent of the normal mean, and a segment more than 2.5 deviations
/// below it scores 1 at least. Segments without a value have no score.
SegmentScores score_segments(SegmentModel model, const PolarGrid& grid, const PolarValues& perfusion,
                             const std::vector<double>& area, const NormalMap* normal);

/// A person's score in place of the computed one. Throws InputError unless the segment exists and the score is 0 to 4.
void set_score(SegmentScores& scores, int segment, int score);

}  // namespace dynasurf::ventricle
