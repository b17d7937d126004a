#include "dynasurf/psf_fit/detail/wall_model.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"

namespace dynasurf::psf_fit {
namespace {

struct Wave {
  int number;  // waves per beat
  std::vector<double> values;
};

/// 1, cosines and sines over the gates, each with a mean square of 1.
std::vector<Wave> waves_up_to(int number, int gates) {
  std::vector<Wave> waves{{0, std::vector<double>(gates, 1.0)}};
  for (int n = 1; n <= number && 2 * n <= gates; ++n)
    for (int phase = 0; phase < 2; ++phase) {
      // At half as many waves as gates the sine is 0 in every gate, and the cosine is +1 and -1.
      if (2 * n == gates && phase == 1) continue;
      Wave wave{n, {}};
      const double scale = 2 * n == gates ? 1 : std::sqrt(2.0);
      for (int g = 0; g < gates; ++g) {
        const double angle = 2 * M_PI * n * g / gates;
        wave.values.push_back(scale * (phase == 0 ? own::cos(angle) : own::sin(angle)));
      }
      waves.push_back(std::move(wave));
    }
  return waves;
}

/// The part of a wave in the start: waves are orthonormal over the gates.
double mean_product(const Wave& wave, const std::vector<Eigen::VectorXd>& start, int number) {
  double sum = 0;
  for (std::size_t g = 0; g < start.size(); ++g) sum += wave.values[g] * start[g][number];
  return sum / start.size();
}

/// Adds unknowns one by one, with what is believed of them.
struct Builder {
  BeatLayout& layout;
  const std::vector<Eigen::VectorXd>& start;
  std::vector<double> value, expected, spread;

  void add(int number, const Wave& wave, double mean, double sd) {
    const double begin = mean_product(wave, start, number);
    for (int g = 0; g < layout.gates; ++g) layout.terms[g][number].push_back({layout.unknowns, wave.values[g]});
    ++layout.unknowns;
    value.push_back(begin);
    expected.push_back(std::isfinite(mean) ? mean : begin);
    spread.push_back(sd);
  }
};

constexpr double as_it_starts = std::numeric_limits<double>::quiet_NaN();

// Low harmonics carry the beat and get as many waves as eight gates can show; fine ones follow slowly.
constexpr int low_degree = 2, low_waves = 5, fine_waves = 2;

void add_cavity(Builder& build, const GateLayout& gate, std::span<const Wave> waves, const Priors& beliefs) {
  for (int k = 0; k < harmonics_up_to(gate.endo_degree); ++k) {
    const int l = degree_of_harmonic(k);
    const bool low = l <= low_degree;
    for (const Wave& wave : waves) {
      const double n = wave.number;
      if (!low && wave.number > fine_waves) continue;
      if (wave.number == 0) {
        const double spread = l == 0 ? beliefs.size
                              : low  ? beliefs.shape / l
                                     : beliefs.fine_shape * own::pow(2.0 / l, 2.5);
        build.add(gate.endo + k, wave, low ? as_it_starts : 0, spread);
      } else {
        const double spread = l == 0 ? beliefs.beating
                              : low  ? beliefs.motion
                                     : beliefs.fine_motion * own::pow(2.0 / l, 2);
        build.add(gate.endo + k, wave, 0, spread / (n * std::sqrt(n)));
      }
    }
  }
}

void add_wall(Builder& build, const GateLayout& gate, std::span<const Wave> waves, const Priors& beliefs) {
  for (int k = 0; k < harmonics_up_to(gate.wall_degree); ++k) {
    const int l = degree_of_harmonic(k);
    for (const Wave& wave : waves) {
      const double n = wave.number;
      if (wave.number > (l <= low_degree ? low_waves : fine_waves)) continue;
      if (wave.number == 0)
        build.add(gate.wall + k, wave, as_it_starts, l == 0 ? 1.5 : beliefs.wall_shape / l);
      else
        build.add(gate.wall + k, wave, 0, beliefs.wall_motion / (std::max(1, l) * n));
    }
  }
}

}  // namespace

GateLayout make_gate_layout(int endo_degree, int wall_degree, int uptake_degree, int blob_count,
                            int attenuation_count) {
  GateLayout l;
  l.endo_degree = endo_degree, l.wall_degree = wall_degree, l.uptake_degree = uptake_degree;
  l.wall = l.endo + harmonics_up_to(endo_degree);
  l.uptake = l.wall + harmonics_up_to(wall_degree);
  l.plane = l.uptake + harmonics_up_to(uptake_degree);
  l.cavity = l.plane + 3;
  l.background = l.cavity + 1;
  l.width = l.background + 1;
  l.stretch = l.width + 1;
  l.attenuation = l.stretch + 2;
  l.attenuation_count = attenuation_count;
  l.blobs = l.attenuation + attenuation_count;
  l.blob_count = blob_count;
  return l;
}

Eigen::VectorXd BeatLayout::at_gate(int g, const Eigen::VectorXd& of_beat) const {
  Eigen::VectorXd numbers = Eigen::VectorXd::Zero(gate.count());
  for (int i = 0; i < gate.count(); ++i)
    for (const Term& t : terms[g][i]) numbers[i] += t.factor * of_beat[t.unknown];
  return numbers;
}

std::vector<Eigen::VectorXd> BeatLayout::at_gates(const Eigen::VectorXd& of_beat) const {
  std::vector<Eigen::VectorXd> numbers(gates);
  for (int g = 0; g < gates; ++g) numbers[g] = at_gate(g, of_beat);
  return numbers;
}

void BeatLayout::add_gradient(int g, const Eigen::VectorXd& of_gate, Eigen::VectorXd& of_beat) const {
  for (int i = 0; i < gate.count(); ++i)
    for (const Term& t : terms[g][i]) of_beat[t.unknown] += t.factor * of_gate[i];
}

Eigen::MatrixXd BeatLayout::hessian(const std::vector<Eigen::MatrixXd>& of_gates) const {
  Eigen::MatrixXd of_beat(unknowns, unknowns);
  // Every unknown belongs to one number, so that the columns of a number are nobody else's.
  constexpr std::size_t numbers_at_once = 16;
  parallel_for(gate.count(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
    Eigen::VectorXd column(unknowns);
    for (std::size_t j = begin; j < end; ++j) {
      for (const Term& b : terms[0][j]) of_beat.col(b.unknown).tail(unknowns - b.unknown).setZero();
      for (int g = 0; g < gates; ++g) {
        if (terms[g][j].empty()) continue;
        column.setZero();
        add_gradient(g, of_gates[g].col(j), column);
        for (const Term& b : terms[g][j])
          of_beat.col(b.unknown).tail(unknowns - b.unknown) += b.factor * column.tail(unknowns - b.unknown);
      }
    }
  });
  return of_beat;
}

BeatLayout make_beat_layout(const GateLayout& gate, const std::vector<Eigen::VectorXd>& start, const Priors& beliefs,
                            Eigen::VectorXd& unknowns) {
  BeatLayout layout;
  layout.gate = gate;
  layout.gates = start.size();
  layout.terms.assign(start.size(), std::vector<std::vector<BeatLayout::Term>>(gate.count()));
  Builder build{layout, start, {}, {}, {}};
  const std::vector<Wave> waves = waves_up_to(low_waves, layout.gates);
  add_cavity(build, gate, waves, beliefs);
  add_wall(build, gate, waves, beliefs);
  for (int k = 0; k < harmonics_up_to(gate.uptake_degree); ++k) {
    const int l = degree_of_harmonic(k);
    build.add(gate.uptake + k, waves[0], as_it_starts, l == 0 ? 1.0 : beliefs.uptake / l);
  }
  for (const Wave& wave : waves)
    build.add(gate.plane, wave, as_it_starts,
              wave.number == 0 ? beliefs.plane_mm : beliefs.plane_mm / std::sqrt(2.0 * wave.number));
  build.add(gate.plane + 1, waves[0], as_it_starts, beliefs.plane_slope);
  build.add(gate.plane + 2, waves[0], as_it_starts, beliefs.plane_slope);
  build.add(gate.cavity, waves[0], beliefs.cavity_level, beliefs.cavity);
  build.add(gate.background, waves[0], as_it_starts, 1.0);
  if (beliefs.width > 0) build.add(gate.width, waves[0], 0, beliefs.width);
  for (int n = 0; n < 2 && beliefs.stretch > 0; ++n) build.add(gate.stretch + n, waves[0], 0, beliefs.stretch);
  for (int k = 0; k < gate.attenuation_count; ++k)
    build.add(gate.attenuation + k, waves[0], k == 0 ? beliefs.attenuation : 0,
              k == 0 ? beliefs.attenuation : beliefs.coefficient);
  // Neighbours stay, or move a little with the beat.
  for (int b = 0; b < gate.blob_count; ++b)
    for (const Wave& wave : waves)
      if (wave.number <= 1) build.add(gate.blobs + b, wave, 0, wave.number == 0 ? 0.4 : 0.06);

  unknowns = Eigen::Map<Eigen::VectorXd>(build.value.data(), layout.unknowns);
  layout.expected = Eigen::Map<Eigen::VectorXd>(build.expected.data(), layout.unknowns);
  layout.spread = Eigen::Map<Eigen::VectorXd>(build.spread.data(), layout.unknowns);
  return layout;
}

}  // namespace dynasurf::psf_fit
