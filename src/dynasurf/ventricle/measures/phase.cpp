#include "dynasurf/ventricle/measures/detail/phase.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/ventricle/measures/detail/volume_curve.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double bandwidth_share = 0.95;

double in_turn(double deg) {
  const double wrapped = deg - 360 * std::floor(deg / 360);
  return wrapped < 360 ? wrapped : 0;
}

struct Weighted {
  double deg, weight;
};

/// The shortest arc with the share asked for: it begins and ends at a value.
double shortest_arc(std::vector<Weighted> values, double share) {
  std::sort(values.begin(), values.end(),
            [](const Weighted& a, const Weighted& b) { return a.deg != b.deg ? a.deg < b.deg : a.weight < b.weight; });
  double total = 0;
  for (const Weighted& v : values) total += v.weight;
  const std::size_t n = values.size();
  const double wanted = share * total * (1 - 1e-12);
  double best = 360, inside = 0;
  std::size_t end = 0;  // one past the last value of the arc, counted on around the circle
  for (std::size_t begin = 0; begin < n; ++begin) {
    while (end < begin + n && inside < wanted) inside += values[end++ % n].weight;
    const double last = values[(end - 1) % n].deg + (end - 1 >= n ? 360 : 0);
    best = std::min(best, last - values[begin].deg);
    inside -= values[begin].weight;
  }
  return best;
}

}  // namespace

std::optional<double> onset_phase_deg(std::span<const double> values, double least_amplitude) {
  if (values.size() < 4) return std::nullopt;
  const PeriodicCurve wave = fit_periodic(values, 1);
  const double amplitude = own::hypot(wave.cosine[0], wave.sine[0]);
  if (!(amplitude > 0) || amplitude < least_amplitude) return std::nullopt;
  // a cos t + b sin t peaks at atan2(b, a) and rises through 0 a quarter of a turn before.
  return in_turn(own::atan2(wave.sine[0], wave.cosine[0]) / degrees - 90);
}

std::optional<PhaseSummary> summarise_phases(std::span<const std::optional<double>> phase_deg,
                                             std::span<const double> weight) {
  PhaseSummary summary;
  std::vector<Weighted> values;
  double all = 0, with_phase = 0, c = 0, s = 0;
  for (std::size_t n = 0; n < phase_deg.size(); ++n) {
    all += weight[n];
    if (!phase_deg[n] || !(weight[n] > 0)) continue;
    values.push_back({in_turn(*phase_deg[n]), weight[n]});
    with_phase += weight[n];
    c += weight[n] * own::cos(*phase_deg[n] * degrees), s += weight[n] * own::sin(*phase_deg[n] * degrees);
  }
  if (values.empty()) return std::nullopt;
  summary.wall_share = with_phase / all;
  summary.mean_deg = in_turn(own::atan2(s, c) / degrees);

  summary.histogram_percent.assign(std::lround(360 / summary.bin_deg), 0.0);
  double squares = 0;
  for (const Weighted& v : values) {
    const double difference = std::remainder(v.deg - summary.mean_deg, 360.0);
    squares += v.weight * difference * difference;
    const auto bin = std::min<std::size_t>(v.deg / summary.bin_deg, summary.histogram_percent.size() - 1);
    summary.histogram_percent[bin] += 100 * v.weight / with_phase;
  }
  summary.sd_deg = std::sqrt(squares / with_phase);
  summary.bandwidth_deg = shortest_arc(values, bandwidth_share);
  for (const double percent : summary.histogram_percent)
    if (percent > 0)
      summary.entropy_percent -= percent * own::log(percent / 100) / own::log(summary.histogram_percent.size());
  return summary;
}

}  // namespace dynasurf::ventricle
