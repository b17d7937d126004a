#pragma once
#include <optional>
#include <span>
#include <vector>

namespace dynasurf::ventricle {

/// A value over the beat as a mean and a few waves. `phase` is the part of the beat after the R wave, 0 to 1.
struct PeriodicCurve {
  double mean = 0;
  std::vector<double> cosine, sine;  // of waves 1, 2, ...

  double at(double phase) const;
  double slope(double phase) const;  // per beat
};

/// Least-squares fit to one value per gate; gate g of n stands for the phase (g + 1/2) / n, its middle. At most
/// (n - 1) / 2 waves can be told apart: fewer are fitted when `waves` is larger. A single value has no waves.
PeriodicCurve fit_periodic(std::span<const double> values, int waves);

/// What the curve was before each gate averaged it over 1/n of the beat: wave k was damped by sin(x)/x, x = pi k / n.
PeriodicCurve without_gate_averaging(PeriodicCurve curve, int gates);

/// Global function from a periodic fit of the cavity's volume. Times count from the R wave in beats (0 to 1) unless
/// named otherwise; a rate is in end-diastolic volumes per beat. With the R-R interval, multiply a time by it and
/// divide a rate by it (`per_second`).
struct VolumeCurveFit {
  PeriodicCurve curve;
  int waves = 0;
  double edv_ml = 0, esv_ml = 0, sv_ml = 0;
  std::optional<double> ef_percent;  // absent when edv is not positive
  double ed_time = 0, es_time = 0;   // of the largest and the smallest volume
  double peak_emptying = 0;          // EDV/beat, positive
  double peak_filling = 0;           // EDV/beat
  double peak_filling_time = 0;      // of the fastest filling
  double time_to_peak_filling = 0;   // beats from end-systole to there
  double first_third_filling = 0;    // share of the stroke volume that has come back after a third of diastole
  double first_third_rate = 0;       // EDV/beat, mean over that third
  double end_rapid_filling = 0;      // time from which filling stays below half of its fastest (CARD-CURVE)
  double residual_ml = 0;            // root mean square of data minus fit
  // What EDV, ESV and EF of the same waves would be had the gates been instants (`without_gate_averaging`): shown
  // beside the numbers above, never mixed into them. An upper bound for curves with kinks (docs/stages/measures.md).
  double instant_edv_ml = 0, instant_esv_ml = 0;
  std::optional<double> instant_ef_percent;
};

/// Fits the volumes of the gates (in the order of the beat). Diastole lasts from the fit's smallest volume to its next
/// largest. Absent for fewer than 5 gates, a volume that is not finite, or a flat curve.
std::optional<VolumeCurveFit> fit_volume_curve(std::span<const double> cavity_ml, int waves = 3);

/// Rates of `fit_volume_curve` in EDV/s; absent when the R-R interval is unknown (0).
std::optional<double> per_second(double rate_per_beat, double cycle_ms);

}  // namespace dynasurf::ventricle
