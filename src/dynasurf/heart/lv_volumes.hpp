#pragma once
#include <optional>
#include <span>
#include <vector>

namespace dynasurf::heart {

/// Volumes of the cavity over the beat (CARD-VOL, CARD-EF, thesis appendix C).
struct LvVolumes {
  double edv_ml = 0;                 // largest cavity volume of the cycle
  double esv_ml = 0;                 // smallest
  double sv_ml = 0;                  // edv - esv
  std::optional<double> ef_percent;  // 100 sv/edv (eq. 6.4); absent when edv is not positive
  int ed_gate = 0, es_gate = 0;      // 0-based; the first of equals
};
/// Absent for fewer than two gates: one volume has no ejection fraction.
std::optional<LvVolumes> lv_volumes(std::span<const double> cavity_ml);

/// The three phases that the thesis sees in the volume curve (CARD-CURVE, figure C.1): fast fall from end diastole to
/// end systole, fast rise, slow rise. Gates are 0-based and count around the cycle from end diastole.
struct CurvePhases {
  int end_diastole = 0, end_systole = 0;
  int end_rapid_filling = 0;  // first gate after end systole from which the rise stays below half of its fastest
};
/// Absent for fewer than four gates or a flat curve.
std::optional<CurvePhases> phases_of_curve(std::span<const double> cavity_ml);

/// How far values around a cycle jump from their smooth course: root mean square of what two waves (three from 12
/// values on) leave of them, over their mean, free of the number of waves. 0 for fewer than six values or a mean of 0.
double cycle_roughness(std::span<const double> values);

/// Standard deviation over mean (CARD-SANITY): muscle does not change its volume during the beat, an edge-derived wall
/// does. 0 for fewer than two values.
double coefficient_of_variation(std::span<const double> values);

}  // namespace dynasurf::heart
