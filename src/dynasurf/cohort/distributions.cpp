#include <array>
#include <cmath>
#include <limits>

#include "dynasurf/cohort/detail/statistics.hpp"
#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::cohort {
namespace {

constexpr double smallest = 1e-300, accuracy = 1e-15;
constexpr int most_terms = 100'000;

/// Logarithm of the gamma function for x > 0, by Lanczos' sum with g = 7 (Godfrey 2001), good to about 1e-14.
double log_gamma(double x) {
  constexpr std::array<double, 9> c{0.99999999999980993,  676.5203681218851,     -1259.1392167224028,
                                    771.32342877765313,   -176.61502916214059,   12.507343278686905,
                                    -0.13857109526572012, 9.9843695780195716e-6, 1.5056327351493116e-7};
  constexpr double log_of_root_of_two_pi = 0.91893853320467274;
  if (x < 0.5) {
    constexpr double pi = 3.14159265358979323846;
    return own::log(pi / own::sin(pi * x)) - log_gamma(1 - x);
  }
  double sum = c[0];
  for (std::size_t n = 1; n < c.size(); ++n) sum += c[n] / (x - 1 + n);
  const double t = x + 6.5;
  return log_of_root_of_two_pi + (x - 0.5) * own::log(t) - t + own::log(sum);
}

/// Continued fraction of the incomplete beta function by the method of Lentz (Numerical Recipes, 6.4).
double beta_fraction(double a, double b, double x) {
  const auto away_from_zero = [](double v) { return std::abs(v) < smallest ? smallest : v; };
  double c = 1, d = 1 / away_from_zero(1 - (a + b) * x / (a + 1)), h = d;
  for (int m = 1; m <= most_terms; ++m) {
    const double two = 2.0 * m;
    for (const double term :
         {m * (b - m) * x / ((a + two - 1) * (a + two)), -(a + m) * (a + b + m) * x / ((a + two) * (a + two + 1))}) {
      d = 1 / away_from_zero(1 + term * d);
      c = away_from_zero(1 + term / c);
      h *= d * c;
    }
    if (std::abs(d * c - 1) < accuracy) break;
  }
  return h;
}

/// The regularized incomplete beta function.
double incomplete_beta(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const double front = own::exp(log_gamma(a + b) - log_gamma(a) - log_gamma(b) + a * own::log(x) + b * own::log(1 - x));
  return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

/// The regularized lower incomplete gamma function: a series below a + 1, a continued fraction above.
double incomplete_gamma(double a, double x) {
  if (x <= 0) return 0;
  const double front = own::exp(a * own::log(x) - x - log_gamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (double n = a + 1; std::abs(term) > std::abs(sum) * accuracy; ++n) sum += term *= x / n;
    return front * sum;
  }
  double b = x + 1 - a, c = 1 / smallest, d = 1 / b, h = d;
  for (int n = 1; n <= most_terms; ++n) {
    const double term = -n * (n - a);
    b += 2;
    d = 1 / (std::abs(term * d + b) < smallest ? smallest : term * d + b);
    c = std::abs(b + term / c) < smallest ? smallest : b + term / c;
    h *= d * c;
    if (std::abs(d * c - 1) < accuracy) break;
  }
  return 1 - front * h;
}

/// Where a growing probability reaches `p`, between `low` and a bound that is doubled until it is above.
template <class Probability>
double where_reached(double p, double low, const Probability& probability) {
  double high = 1;
  while (probability(high) < p && high < std::numeric_limits<double>::max() / 4) high *= 2;
  for (int n = 0; n < 200 && high - low > accuracy * std::abs(high); ++n) {
    const double middle = low + (high - low) / 2;
    (probability(middle) < p ? low : high) = middle;
  }
  return low + (high - low) / 2;
}

}  // namespace

double student_t_probability(double t, double degrees) {
  const double tail = 0.5 * incomplete_beta(degrees / 2, 0.5, degrees / (degrees + t * t));
  return t < 0 ? tail : 1 - tail;
}

double student_t_quantile(double p, double degrees) {
  if (p < 0.5) return -student_t_quantile(1 - p, degrees);
  return where_reached(p, 0, [&](double t) { return student_t_probability(t, degrees); });
}

double f_probability(double f, double degrees1, double degrees2) {
  return f <= 0 ? 0 : incomplete_beta(degrees1 / 2, degrees2 / 2, degrees1 * f / (degrees1 * f + degrees2));
}

double f_quantile(double p, double degrees1, double degrees2) {
  return where_reached(p, 0, [&](double f) { return f_probability(f, degrees1, degrees2); });
}

double chi_squared_probability(double x, double degrees) { return incomplete_gamma(degrees / 2, x / 2); }

double chi_squared_quantile(double p, double degrees) {
  return where_reached(p, 0, [&](double x) { return chi_squared_probability(x, degrees); });
}

}  // namespace dynasurf::cohort
