#include "dynasurf/heart/lv_volumes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::heart {

std::optional<LvVolumes> lv_volumes(std::span<const double> cavity_ml) {
  if (cavity_ml.size() < 2) return std::nullopt;
  const auto largest = std::max_element(cavity_ml.begin(), cavity_ml.end());
  const auto smallest = std::min_element(cavity_ml.begin(), cavity_ml.end());
  LvVolumes f;
  f.edv_ml = *largest;
  f.esv_ml = *smallest;
  f.sv_ml = f.edv_ml - f.esv_ml;
  if (f.edv_ml > 0) f.ef_percent = 100 * f.sv_ml / f.edv_ml;
  f.ed_gate = largest - cavity_ml.begin();
  f.es_gate = smallest - cavity_ml.begin();
  return f;
}

std::optional<CurvePhases> phases_of_curve(std::span<const double> cavity_ml) {
  const int n = cavity_ml.size();
  const std::optional<LvVolumes> f = lv_volumes(cavity_ml);
  if (n < 4 || !f || f->sv_ml <= 0) return std::nullopt;
  const auto volume = [&](int gate) { return cavity_ml[gate % n]; };
  CurvePhases phases{f->ed_gate, f->es_gate, f->es_gate};
  const int filling = (f->ed_gate - f->es_gate + n) % n;  // gates from end systole to the next end diastole
  double fastest = 0;
  for (int s = 0; s < filling; ++s) fastest = std::max(fastest, volume(f->es_gate + s + 1) - volume(f->es_gate + s));
  int last_fast = 0;
  for (int s = 0; s < filling; ++s)
    if (volume(f->es_gate + s + 1) - volume(f->es_gate + s) >= 0.5 * fastest) {
      last_fast = s + 1;
    } else if (last_fast > 0) {
      break;
    }
  phases.end_rapid_filling = (f->es_gate + last_fast) % n;
  return phases;
}

double cycle_roughness(std::span<const double> values) {
  const double n = values.size();
  if (values.size() < 6) return 0;
  const int waves = values.size() >= 12 ? 3 : 2;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  if (mean == 0) return 0;
  // Waves sampled evenly over whole cycles are orthogonal, so each is fitted by itself.
  std::vector<double> rest(values.begin(), values.end());
  for (double& v : rest) v -= mean;
  for (int w = 1; w <= waves; ++w) {
    double c = 0, s = 0;
    for (std::size_t g = 0; g < rest.size(); ++g) {
      const double angle = 2 * std::numbers::pi * w * g / n;
      c += rest[g] * own::cos(angle) * 2 / n, s += rest[g] * own::sin(angle) * 2 / n;
    }
    for (std::size_t g = 0; g < rest.size(); ++g) {
      const double angle = 2 * std::numbers::pi * w * g / n;
      rest[g] -= c * own::cos(angle) + s * own::sin(angle);
    }
  }
  double squares = 0;
  for (double v : rest) squares += v * v;
  // The degrees of freedom that the mean and the waves leave: one at least, from six gates on.
  return std::sqrt(squares / (n - 1 - 2 * waves)) / std::abs(mean);
}

double coefficient_of_variation(std::span<const double> values) {
  if (values.size() < 2) return 0;
  const double n = values.size();
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (double v : values) squares += (v - mean) * (v - mean);
  return mean != 0 ? std::sqrt(squares / (n - 1)) / std::abs(mean) : 0;
}

}  // namespace dynasurf::heart
