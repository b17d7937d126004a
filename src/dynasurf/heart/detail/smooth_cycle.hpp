#pragma once
#include <optional>
#include <span>
#include <vector>

namespace dynasurf::heart {

/// One number per gate as a heart changes it: smoothly, and the same after a beat.
struct SmoothCycle {
  std::vector<double> values;  // one per gate
  std::vector<bool> outlier;   // the gate has no number, or one farther than `cut` from its smooth value
};

/// A constant and waves around the cycle (three from 12 gates on, two from 6, one from 4, else none; no more than
/// `most_waves`) laid through the
/// numbers that are there by robust least squares: what lies farther than `cut` (in their unit) does not count.
/// All values are 0 where no gate has a number.
SmoothCycle smooth_over_cycle(std::span<const std::optional<double>> values, double cut, int most_waves = 3);

}  // namespace dynasurf::heart
