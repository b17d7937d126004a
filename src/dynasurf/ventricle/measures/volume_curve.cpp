#include "dynasurf/ventricle/measures/detail/volume_curve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double turn = 2 * std::numbers::pi;
constexpr int instants =
    3600;  // of the beat at which extremes are looked for: their values are exact to 1e-6 of a wave

double wrapped(double phase) { return phase - std::floor(phase); }

/// Extremes of a function of the phase on the circle, from `from` over `length` of it.
template <class F>
double where_largest(double from, double length, const F& value) {
  double best = from, largest = value(from);
  const int steps = std::max(1, round_int(length * instants));
  for (int n = 1; n <= steps; ++n) {
    const double phase = from + length * n / steps;
    if (const double v = value(phase); v > largest) largest = v, best = phase;
  }
  return best;
}

double residual(const PeriodicCurve& curve, std::span<const double> values) {
  double squares = 0;
  const double n = values.size();
  for (std::size_t g = 0; g < values.size(); ++g) {
    // The volume of a gate is that of its middle.
    const double miss = values[g] - curve.at((g + 0.5) / n);
    squares += miss * miss;
  }
  return std::sqrt(squares / n);
}

std::optional<double> ef_of(double edv, double esv) {
  return edv > 0 ? std::optional(100 * (edv - esv) / edv) : std::nullopt;
}

/// Emptying between the extremes, filling after them.
void measure_rates(VolumeCurveFit& f) {
  const PeriodicCurve& curve = f.curve;
  const double systole = wrapped(f.es_time - f.ed_time), diastole = 1 - systole;
  const auto slope = [&](double t) { return curve.slope(t); };
  f.peak_emptying = -slope(where_largest(f.ed_time, systole, [&](double t) { return -slope(t); })) / f.edv_ml;

  const double fastest = where_largest(f.es_time, diastole, slope);
  f.peak_filling = slope(fastest) / f.edv_ml;
  f.peak_filling_time = wrapped(fastest);
  f.time_to_peak_filling = fastest - f.es_time;
  const double third = curve.at(f.es_time + diastole / 3) - f.esv_ml;
  f.first_third_filling = third / f.sv_ml;
  f.first_third_rate = third / (diastole / 3) / f.edv_ml;

  double end = fastest;
  while (end < f.es_time + diastole && slope(end) >= 0.5 * slope(fastest)) end += 1.0 / instants;
  f.end_rapid_filling = wrapped(end);
}

}  // namespace

double PeriodicCurve::at(double phase) const {
  double value = mean;
  for (std::size_t k = 0; k < cosine.size(); ++k) {
    const double angle = turn * (k + 1) * phase;
    value += cosine[k] * own::cos(angle) + sine[k] * own::sin(angle);
  }
  return value;
}

double PeriodicCurve::slope(double phase) const {
  double value = 0;
  for (std::size_t k = 0; k < cosine.size(); ++k) {
    const double speed = turn * (k + 1);
    value += speed * (sine[k] * own::cos(speed * phase) - cosine[k] * own::sin(speed * phase));
  }
  return value;
}

PeriodicCurve fit_periodic(std::span<const double> values, int waves) {
  PeriodicCurve curve;
  if (values.empty()) return curve;
  const double n = values.size();
  curve.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  // Waves sampled evenly over the whole beat are orthogonal, so each is fitted by itself.
  const int most = (std::ssize(values) - 1) / 2;
  for (int k = 1; k <= std::min(waves, most); ++k) {
    double c = 0, s = 0;
    for (std::size_t g = 0; g < values.size(); ++g) {
      const double angle = turn * k * (g + 0.5) / n;
      c += values[g] * own::cos(angle) * 2 / n, s += values[g] * own::sin(angle) * 2 / n;
    }
    curve.cosine.push_back(c), curve.sine.push_back(s);
  }
  return curve;
}

PeriodicCurve without_gate_averaging(PeriodicCurve curve, int gates) {
  for (std::size_t k = 0; k < curve.cosine.size(); ++k) {
    // The mean over a gate, 1 / gates of the beat long, has scaled wave k by sin(x) / x.
    const double x = std::numbers::pi * (k + 1) / gates;
    curve.cosine[k] *= x / own::sin(x), curve.sine[k] *= x / own::sin(x);
  }
  return curve;
}

std::optional<VolumeCurveFit> fit_volume_curve(std::span<const double> cavity_ml, int waves) {
  if (cavity_ml.size() < 5) return std::nullopt;
  if (!std::all_of(cavity_ml.begin(), cavity_ml.end(), [](double v) { return std::isfinite(v); })) return std::nullopt;
  VolumeCurveFit f;
  f.curve = fit_periodic(cavity_ml, waves);
  f.waves = f.curve.cosine.size();
  const auto extremes = [](const PeriodicCurve& curve) {
    return std::pair(where_largest(0, 1, [&](double t) { return curve.at(t); }),
                     where_largest(0, 1, [&](double t) { return -curve.at(t); }));
  };
  const auto [ed, es] = extremes(f.curve);
  f.ed_time = wrapped(ed), f.es_time = wrapped(es);
  f.edv_ml = f.curve.at(ed), f.esv_ml = f.curve.at(es), f.sv_ml = f.edv_ml - f.esv_ml;
  if (!(f.sv_ml > 1e-9 * std::abs(f.edv_ml))) return std::nullopt;
  f.ef_percent = ef_of(f.edv_ml, f.esv_ml);
  f.residual_ml = residual(f.curve, cavity_ml);
  measure_rates(f);

  const PeriodicCurve instant = without_gate_averaging(f.curve, cavity_ml.size());
  const auto [instant_ed, instant_es] = extremes(instant);
  f.instant_edv_ml = instant.at(instant_ed), f.instant_esv_ml = instant.at(instant_es);
  f.instant_ef_percent = ef_of(f.instant_edv_ml, f.instant_esv_ml);
  return f;
}

std::optional<double> per_second(double rate_per_beat, double cycle_ms) {
  return cycle_ms > 0 ? std::optional(rate_per_beat * 1000 / cycle_ms) : std::nullopt;
}

}  // namespace dynasurf::ventricle
