#include "dynasurf/ventricle/measures/detail/regional_errors.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/ventricle/measures/detail/reference.hpp"

namespace dynasurf::ventricle {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Weights with which samples make up the number of each segment: a row per sample, a column per segment.
MatrixXd segment_weights(const Measures& m, const PolarValues& values) {
  MatrixXd weights = MatrixXd::Zero(m.grid.size(), m.segments.size());
  for (std::size_t n = 0; n < m.grid.size(); ++n) {
    const int s = segment_at(m.model, m.grid.point(n));
    if (s > 0 && values[n]) weights(n, s - 1) = m.area_mm2[n];
  }
  for (Index s = 0; s < weights.cols(); ++s)
    if (const double sum = weights.col(s).sum(); sum > 0) weights.col(s) /= sum;
  return weights;
}

/// Numbers of the beat as they depend on the walls of its gates.
class Wall {
 public:
  Wall(const Measures& m, const psf_fit::WallPosterior& posterior) : m_(m), posterior_(posterior) {}

  const WallMap& map(int gate) const { return m_.gates[gate].map; }
  MatrixXd nothing(Index numbers) const { return posterior_.no_gradient(numbers); }
  VectorXd sd(const MatrixXd& gradient) const { return posterior_.sd(gradient); }

  /// Derivatives of sums of the thickness over the samples of a gate.
  void add_thickness(int gate, const MatrixXd& weights, MatrixXd& gradient) const {
    const WallMap& wall = map(gate);
    VectorXd scale = VectorXd::Zero(weights.rows());
    for (std::size_t n = 0; n < wall.endo.size(); ++n)
      if (wall.endo[n] && wall.epi[n] && wall.thickness_mm[n])
        scale[n] = *wall.thickness_mm[n] / std::max(1e-6, (*wall.epi[n] - *wall.endo[n]).norm());
    const MatrixXd by_epi = scale.asDiagonal() * weights;
    posterior_.add(gate, {wall.endo, wall.epi}, {-by_epi, by_epi, {}}, gradient);
  }
  /// Of the way of the inner wall outwards along the rays of `rest`; with `relative` of its size, mm per mm.
  void add_place(int gate, const MatrixXd& weights, bool relative, MatrixXd& gradient) const {
    const WallMap& wall = map(gate);
    VectorXd scale = VectorXd::Zero(weights.rows());
    for (std::size_t n = 0; n < wall.endo.size(); ++n)
      if (wall.endo[n])
        scale[n] = relative ? 1 / std::max(1.0, (*wall.endo[n] - m_.gates[gate].axes->centre()).norm()) : 1;
    posterior_.add(gate, {wall.endo, wall.epi}, {scale.asDiagonal() * weights, {}, {}}, gradient);
  }
  void add_log_uptake(int gate, const MatrixXd& weights, MatrixXd& gradient) const {
    posterior_.add(gate, {map(gate).endo, map(gate).epi}, {{}, {}, weights}, gradient);
  }

 private:
  const Measures& m_;
  const psf_fit::WallPosterior& posterior_;
};

/// What the normal matrix does not know: walls and cameras that differ from the model. Its deviations times the factor,
/// and a part that no counting takes away, hold the truth in about 90 % of the segments of the choosing patients of
/// experiments/regional_truth.
struct Allowance {
  double factor, least;
};
constexpr Allowance for_thickness{1.7, 0.4}, for_thickening{1.3, 4}, for_perfusion{1.5, 3}, for_motion{0.9, 0.22},
    for_strain{2, 3}, for_phase{0.9, 1.3}, for_spread{2, 3};

std::optional<double> allowed(double sd, const Allowance& a) {
  return std::isfinite(sd) ? std::optional(own::hypot(a.factor * sd, a.least)) : std::nullopt;
}

void set_all(Measures& m, std::optional<double> SegmentErrors::*member, const VectorXd& sd,
             const Allowance& allowance) {
  for (std::size_t s = 0; s < m.segments.size(); ++s) m.segments[s].sd.*member = allowed(sd[s], allowance);
}

/// Percent of the reference, as `perfusion_percent` is made.
void perfusion_errors(Measures& m, const Wall& wall, int gate) {
  if (m.perfusion_is != Perfusion::uptake) return;
  const PolarValues& percent = m.maps.perfusion_percent;
  MatrixXd weights = segment_weights(m, percent);
  const std::vector<std::size_t> reference = reference_samples(percent, true);
  VectorXd whole = VectorXd::Zero(weights.rows());
  for (const std::size_t n : reference) whole[n] = *percent[n] / 100 / reference.size();
  for (std::size_t n = 0; n < percent.size(); ++n) weights.row(n) *= percent[n].value_or(0);
  for (Index s = 0; s < weights.cols(); ++s) weights.col(s) -= m.segments[s].perfusion_percent.value_or(0) * whole;
  MatrixXd gradient = wall.nothing(weights.cols());
  wall.add_log_uptake(gate, weights, gradient);
  set_all(m, &SegmentErrors::perfusion_percent, wall.sd(gradient), for_perfusion);
}

void thickness_errors(Measures& m, const Wall& wall) {
  const MatrixXd rest = segment_weights(m, m.maps.thickness_ed_mm);
  MatrixXd at_rest = wall.nothing(rest.cols());
  wall.add_thickness(m.ed_gate, rest, at_rest);
  set_all(m, &SegmentErrors::thickness_ed_mm, wall.sd(at_rest), for_thickness);
  if (m.es_gate < 0) return;
  MatrixXd contracted = wall.nothing(rest.cols());
  wall.add_thickness(m.es_gate, segment_weights(m, m.maps.thickness_es_mm), contracted);
  set_all(m, &SegmentErrors::thickness_es_mm, wall.sd(contracted), for_thickness);
  MatrixXd thickening = contracted;
  for (Index s = 0; s < thickening.cols(); ++s) {
    const SegmentMeasures& segment = m.segments[s];
    const double ed = segment.thickness_ed_mm.value_or(0), es = segment.thickness_es_mm.value_or(0);
    thickening.col(s) = 100 * (contracted.col(s) / ed - es / (ed * ed) * at_rest.col(s));
  }
  set_all(m, &SegmentErrors::thickening_percent, wall.sd(thickening), for_thickening);
}

void motion_errors(Measures& m, const Wall& wall) {
  const MatrixXd weights = segment_weights(m, m.maps.motion_mm);
  MatrixXd way = wall.nothing(weights.cols()), size = way;
  for (const double sign : {1.0, -1.0}) {
    const int gate = sign > 0 ? m.ed_gate : m.es_gate;
    wall.add_place(gate, sign * weights, false, way);
    wall.add_place(gate, -2 * sign * weights, true, size);
  }
  const VectorXd moved = wall.sd(way), strained = wall.sd(size);
  set_all(m, &SegmentErrors::motion_mm, moved, for_motion);
  set_all(m, &SegmentErrors::displacement_mm, moved, for_motion);
  for (std::size_t s = 0; s < m.segments.size(); ++s)
    if (const auto& strain = m.segments[s].area_strain_percent)
      m.segments[s].sd.area_strain_percent = allowed((100 + *strain) * strained[s], for_strain);
}

/// Derivative of the onset by the values of the gates, degrees; empty for a curve that is flat.
std::vector<double> onset_by_gate(const std::vector<double>& curve) {
  const double n = curve.size();
  double a = 0, b = 0;
  for (std::size_t g = 0; g < curve.size(); ++g) {
    const double angle = 2 * M_PI * (g + 0.5) / n;
    a += 2 / n * curve[g] * own::cos(angle), b += 2 / n * curve[g] * own::sin(angle);
  }
  if (!(a * a + b * b > 1e-12)) return {};
  std::vector<double> by_gate;
  for (std::size_t g = 0; g < curve.size(); ++g) {
    const double angle = 2 * M_PI * (g + 0.5) / n;
    by_gate.push_back(2 / n * (a * own::sin(angle) - b * own::cos(angle)) / (a * a + b * b) / degrees);
  }
  return by_gate;
}

/// One number of a sample over the beat, and how numbers that are made of it depend on the walls.
struct Onset {
  PolarValues PolarMaps::*map;
  std::optional<PhaseSummary> Measures::*summary;
  std::optional<double> SegmentErrors::*error;
  bool is_motion;
};

void onset_errors(Measures& m, const Wall& wall, const Onset& onset) {
  const std::size_t gates = m.gates.size();
  const PolarValues& phases = m.maps.*onset.map;
  std::vector<std::vector<double>> curves(m.grid.size());
  const WallMap& rest = wall.map(m.ed_gate);
  for (std::size_t n = 0; n < curves.size(); ++n)
    for (std::size_t g = 0; phases[n] && g < gates; ++g) {
      const WallMap& now = wall.map(g);
      curves[n].push_back(onset.is_motion ? (*rest.endo[n] - *now.endo[n]).dot(rest.outwards[n])
                                          : *now.thickness_mm[n]);
    }
  const MatrixXd weights = segment_weights(m, phases);
  const Index segments = weights.cols();
  std::vector<std::vector<double>> of_segment(segments, std::vector<double>(gates, 0.0));
  for (std::size_t n = 0; n < curves.size(); ++n)
    for (Index s = 0; s < segments; ++s)
      for (std::size_t g = 0; g < curves[n].size(); ++g) of_segment[s][g] += weights(n, s) * curves[n][g];
  for (auto& curve : of_segment) curve = onset_by_gate(curve);
  for (auto& curve : curves) curve = onset_by_gate(curve);

  auto& summary = m.*onset.summary;
  double area = 0;
  for (std::size_t n = 0; n < curves.size(); ++n) area += curves[n].empty() ? 0 : m.area_mm2[n];
  MatrixXd gradient = wall.nothing(segments + 1);  // the last: spread of the onsets
  for (std::size_t g = 0; g < gates; ++g) {
    MatrixXd by_value = MatrixXd::Zero(weights.rows(), segments + 1);
    for (Index s = 0; s < segments; ++s)
      if (const auto& by_gate = of_segment[s]; !by_gate.empty()) by_value.col(s) = by_gate[g] * weights.col(s);
    if (summary && summary->sd_deg > 0)
      for (std::size_t n = 0; n < curves.size(); ++n)
        if (!curves[n].empty())
          by_value(n, segments) = curves[n][g] * m.area_mm2[n] / area / summary->sd_deg *
                                  std::remainder(*phases[n] - summary->mean_deg, 360.0);
    if (onset.is_motion)
      wall.add_place(g, -by_value, false, gradient);
    else
      wall.add_thickness(g, by_value, gradient);
  }
  constexpr double unknown_deg = 60;  // so unsure that the angle means nothing
  const VectorXd sd = wall.sd(gradient);
  for (Index s = 0; s < segments; ++s)
    if (sd[s] > 0 && for_phase.factor * sd[s] < unknown_deg) m.segments[s].sd.*onset.error = allowed(sd[s], for_phase);
  if (summary && sd[segments] > 0) summary->sd_error_deg = allowed(sd[segments], for_spread);
}

}  // namespace

void add_error_bars(Measures& m, const psf_fit::WallPosterior& posterior) {
  if (m.segments.empty()) return;
  if (std::any_of(m.gates.begin(), m.gates.end(), [](const GateMeasures& g) { return !g.axes; })) return;
  const Wall wall(m, posterior);
  const bool beats = m.es_gate >= 0;
  // Each writes members of its own. Those that take longest come first.
  const std::vector<std::function<void()>> tasks{
      [&] {
        if (beats && m.phase_motion)
          onset_errors(m, wall,
                       {&PolarMaps::phase_motion_deg, &Measures::phase_motion, &SegmentErrors::phase_motion_deg, true});
      },
      [&] {
        if (beats && m.phase_thickness)
          onset_errors(m, wall,
                       {&PolarMaps::phase_thickness_deg, &Measures::phase_thickness,
                        &SegmentErrors::phase_thickness_deg, false});
      },
      [&] { thickness_errors(m, wall); },
      [&] {
        if (beats) motion_errors(m, wall);
      },
      [&] { perfusion_errors(m, wall, m.ed_gate); }};
  parallel_for(tasks.size(), 1, [&](std::size_t n, std::size_t) { tasks[n](); });
}

}  // namespace dynasurf::ventricle
