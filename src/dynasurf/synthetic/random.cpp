#include "dynasurf/synthetic/detail/random.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::synthetic {
namespace {

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014): every bit of the result depends on all of z.
std::uint64_t scramble(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// log k!, exact to rounding. std::lgamma is avoided: it writes a global sign, a race between threads.
double log_factorial(double k) {
  if (k < 10) {
    double product = 1;
    for (double n = 2; n <= k; ++n) product *= n;
    return own::log(product);
  }
  const double x = k + 1, x2 = x * x;
  constexpr double half_log_two_pi = 0.91893853320467274178;
  // Stirling's series.
  return (x - 0.5) * own::log(x) - x + half_log_two_pi + (1.0 / 12 - (1.0 / 360 - 1.0 / (1260 * x2)) / x2) / x;
}

double poisson_by_multiplication(Random& random, double mean) {
  const double limit = own::exp(-mean);
  double product = random.uniform(), k = 0;
  while (product > limit) {
    product *= random.uniform();
    ++k;
  }
  return k;
}

double poisson_by_rejection(Random& random, double mean) {
  const double b = 0.931 + 2.53 * std::sqrt(mean), a = -0.059 + 0.02483 * b;
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4), v_r = 0.9277 - 3.6224 / (b - 2);
  const double log_mean = own::log(mean);
  for (;;) {
    const double u = random.uniform() - 0.5, v = random.uniform();
    const double us = 0.5 - std::abs(u);
    const double k = std::floor((2 * a / us + b) * u + mean + 0.43);
    if (us >= 0.07 && v <= v_r) return k;
    if (k < 0 || (us < 0.013 && v > us)) continue;
    if (own::log(v * inverse_alpha / (a / (us * us) + b)) <= k * log_mean - mean - log_factorial(k)) return k;
  }
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream, std::uint64_t position)
    : state_(scramble(scramble(scramble(seed + 0x9e3779b97f4a7c15ULL) ^ (stream + 0x632be59bd9b4e019ULL)) +
                      position * 0xd1342543de82ef95ULL)) {}

std::uint64_t Random::next() {
  state_ += 0x9e3779b97f4a7c15ULL;
  return scramble(state_);
}

// The middle of one of 2^53 equal parts: 0, which has no logarithm, never comes out. The middle of the last part is no
// double and would be rounded to 1.
double Random::uniform() { return std::min(((next() >> 11) + 0.5) * 0x1.0p-53, 1 - 0x1.0p-53); }

double Random::normal() {
  for (;;) {
    const double u = 2 * uniform() - 1, v = 2 * uniform() - 1;
    const double s = u * u + v * v;
    if (s < 1 && s > 0) return u * std::sqrt(-2 * own::log(s) / s);
  }
}

double Random::poisson(double mean) {
  DYNASURF_ASSERT(mean >= 0 && std::isfinite(mean));
  if (mean <= 0) return 0;
  return mean < 10 ? poisson_by_multiplication(*this, mean) : poisson_by_rejection(*this, mean);
}

}  // namespace dynasurf::synthetic
