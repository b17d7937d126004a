#pragma once
#include <optional>
#include <span>
#include <vector>

namespace dynasurf::ventricle {

/// Onset of contraction from the first wave of a regional curve that rises in systole (counts, inward motion): where
/// the wave crosses its mean upwards, degrees of the beat after the R wave in [0, 360). Values at the middles of the
/// gates. Absent for fewer than 4 gates or a wave smaller than `least_amplitude` (unit of the values).
std::optional<double> onset_phase_deg(std::span<const double> values, double least_amplitude = 0);

/// How much of the wall begins to contract when (Chen et al., J Nucl Cardiol 12:687, 2005): angles of the beat.
struct PhaseSummary {
  double mean_deg = 0;                    // circular mean, [0, 360)
  double sd_deg = 0;                      // standard deviation about it, differences taken the short way round
  double bandwidth_deg = 0;               // the shortest arc that holds 95 % of the wall
  double entropy_percent = 0;             // of the histogram, 0: one bin, 100: the same in all
  std::vector<double> histogram_percent;  // bins of `bin_deg` from 0
  double bin_deg = 6;
  double wall_share = 0;               // of the weight that has a phase at all
  std::optional<double> sd_error_deg;  // standard deviation of the error of sd_deg, where it is known
};

/// `phase_deg` with weights (areas); absent phases only lower `wall_share`. Absent when nothing has a phase.
std::optional<PhaseSummary> summarise_phases(std::span<const std::optional<double>> phase_deg,
                                             std::span<const double> weight);

}  // namespace dynasurf::ventricle
