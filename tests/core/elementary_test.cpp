#include "dynasurf/core/detail/elementary.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double tiny = std::numeric_limits<double>::denorm_min();
constexpr double largest = std::numeric_limits<double>::max();

using LvVolumes = double (*)(double);
using Judge = long double (*)(long double);

struct OneArgument {
  const char* name;
  LvVolumes function;
  Judge assess;
};

const OneArgument functions[] = {
    {"exp", own::exp, [](long double x) { return std::exp(x); }},
    {"expm1", own::expm1, [](long double x) { return std::expm1(x); }},
    {"log", own::log, [](long double x) { return std::log(x); }},
    {"log2", own::log2, [](long double x) { return std::log2(x); }},
    {"log10", own::log10, [](long double x) { return std::log10(x); }},
    {"erfc", own::erfc, [](long double x) { return std::erfc(x); }},
    {"sin", own::sin, [](long double x) { return std::sin(x); }},
    {"cos", own::cos, [](long double x) { return std::cos(x); }},
    {"tan", own::tan, [](long double x) { return std::tan(x); }},
    {"asin", own::asin, [](long double x) { return std::asin(x); }},
    {"acos", own::acos, [](long double x) { return std::acos(x); }},
    {"cbrt", own::cbrt, [](long double x) { return std::cbrt(x); }},
};

/// Units in the last place between a result and a judge of more digits; 0 for the same infinity or for two NaN.
double units_between(double got, long double expected) {
  if (std::isnan(got) || std::isnan(expected)) return std::isnan(got) == std::isnan(expected) ? 0 : infinity;
  if (std::isinf(got) || std::isinf(static_cast<double>(expected)))
    return got == static_cast<double>(expected) ? 0 : infinity;
  int exponent = 0;
  std::frexp(static_cast<double>(expected), &exponent);
  const long double unit = std::ldexp(1.0L, std::max(exponent - 53, -1074));
  return static_cast<double>(std::abs(static_cast<long double>(got) - expected) / unit);
}

struct Worst {
  double units = 0, at = 0;
  void see(double u, double x) {
    if (!(u <= units)) units = u, at = x;
  }
};

// A long double must be wider than a double to judge it, as it is where processors have the numbers of the 8087.
constexpr bool has_judge = std::numeric_limits<long double>::digits >= 64;
// What elementary.hpp promises; the judge itself errs by less than 1/1000 of that.
constexpr double promised = 1.0;

/// Splitmix: the same arguments on every machine.
std::uint64_t bits_of(std::uint64_t n) {
  std::uint64_t z = (n + 1) * 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}
double share_of(std::uint64_t n) { return static_cast<double>(bits_of(n) >> 11) * 0x1p-53; }

/// Numbers of all sizes and both signs, most of them where functions change.
double argument(std::uint64_t n) {
  const double u = share_of(2 * n);
  switch (bits_of(2 * n + 1) % 4) {
    case 0:
      return 2 * u - 1;
    case 1:
      return 40 * (2 * u - 1);
    case 2:
      return 1 + (u - 0.5) / 64;
    default:
      return std::bit_cast<double>(bits_of(2 * n));
  }
}

class EachFunction : public testing::TestWithParam<OneArgument> {};
INSTANTIATE_TEST_SUITE_P(Own, EachFunction, testing::ValuesIn(functions),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(EachFunction, ErrsByLessThanOneUnitInTheLastPlace) {
  if (!has_judge) GTEST_SKIP() << "long double is a double here";
  Worst worst;
  for (std::uint64_t n = 0; n < 200'000; ++n) {
    const double x = argument(n);
    worst.see(units_between(GetParam().function(x), GetParam().assess(x)), x);
  }
  EXPECT_LT(worst.units, promised) << GetParam().name << "(" << std::hexfloat << worst.at << ")";
}

// DYNASURF_FLOATS=1 asks for every float there is: minutes for each function.
TEST_P(EachFunction, ErrsByLessThanOneUnitForFloats) {
  if (!has_judge) GTEST_SKIP() << "long double is a double here";
  const char* asked = std::getenv("DYNASURF_FLOATS");
  const std::uint64_t step = asked ? std::strtoull(asked, nullptr, 10) : 30011;
  ASSERT_GT(step, 0U);
  Worst worst;
  for (std::uint64_t n = 0; n < 0x1'0000'0000; n += step) {
    const double x = std::bit_cast<float>(static_cast<std::uint32_t>(n));
    worst.see(units_between(GetParam().function(x), GetParam().assess(x)), x);
  }
  std::printf("%s: %.4f units at %a\n", GetParam().name, worst.units, worst.at);
  EXPECT_LT(worst.units, promised) << GetParam().name << "(" << std::hexfloat << worst.at << ")";
}

TEST(Elementary, FunctionsOfTwoNumbersErrByLessThanOneUnit) {
  if (!has_judge) GTEST_SKIP() << "long double is a double here";
  double pow = 0, atan2 = 0, hypot = 0;
  for (std::uint64_t n = 0; n < 200'000; ++n) {
    const double x = argument(2 * n), y = argument(2 * n + 1), size = std::abs(x);
    const long double a = x, b = y;
    pow = std::max(pow, units_between(own::pow(size, y), std::pow(std::abs(a), b)));
    atan2 = std::max(atan2, units_between(own::atan2(y, x), std::atan2(b, a)));
    hypot = std::max(hypot, units_between(own::hypot(x, y), std::hypot(a, b)));
    hypot = std::max(hypot, units_between(own::hypot(x, y, 0.7 * x), std::hypot(std::hypot(a, b), 0.7 * x)));
  }
  EXPECT_LT(pow, promised);
  EXPECT_LT(atan2, promised);
  EXPECT_LT(hypot, promised);
}

/// The same bits, or two NaN.
::testing::AssertionResult same(double got, double expected) {
  if (std::isnan(got) && std::isnan(expected)) return ::testing::AssertionSuccess();
  if (std::bit_cast<std::uint64_t>(got) == std::bit_cast<std::uint64_t>(expected)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << std::hexfloat << got << " instead of " << expected;
}

TEST(Elementary, OddArgumentsFollowC) {
  for (const OneArgument& f : functions)
    for (const double x : {0.0, -0.0, infinity, -infinity, nan, 1.0, -1.0, tiny, -tiny, 2.0, -2.0})
      EXPECT_TRUE(same(f.function(x), static_cast<double>(f.assess(x)))) << f.name << " of " << x;
}

TEST(Elementary, OddPowersAndAnglesFollowC) {
  const std::vector<double> odd = {0.0, -0.0, infinity, -infinity, nan, 1.0, -1.0, tiny, largest, 3.0, -3.0, 0.5, -0.5};
  for (const double x : odd)
    for (const double y : odd) {
      EXPECT_TRUE(same(own::pow(x, y), std::pow(x, y))) << "pow(" << x << ", " << y << ")";
      EXPECT_TRUE(same(own::atan2(y, x), std::atan2(y, x))) << "atan2(" << y << ", " << x << ")";
      EXPECT_TRUE(same(own::hypot(x, y), std::hypot(x, y))) << "hypot(" << x << ", " << y << ")";
    }
}

TEST(Elementary, WhatIsExactComesOutExact) {
  for (int n = -300; n <= 300; ++n) {
    const double x = n, cube = x * x * x, two = std::ldexp(1.0, n);
    EXPECT_EQ(own::cbrt(cube), x);
    EXPECT_EQ(own::hypot(3 * x, 4 * x), std::abs(5 * x));
    EXPECT_EQ(own::hypot(2 * x, 3 * x, 6 * x), std::abs(7 * x));
    EXPECT_EQ(own::log2(two), x);
    EXPECT_EQ(own::pow(2, n), two);
    EXPECT_EQ(own::pow(x, 2), x * x);
    EXPECT_EQ(own::pow(x, 3), cube);
    EXPECT_EQ(own::pow(x * x, 0.5), std::abs(x));
  }
  double ten = 1;
  for (int n = 0; n <= 22; ++n, ten *= 10) {
    EXPECT_EQ(own::pow(10, n), ten);
    EXPECT_EQ(own::log10(ten), n);
  }
  EXPECT_EQ(own::exp(0), 1);
  EXPECT_EQ(own::cos(0), 1);
  EXPECT_EQ(own::erfc(0), 1);
  EXPECT_EQ(own::acos(1), 0);
}

TEST(Elementary, LargeAnglesAreReducedWithoutLoss) {
  // The double that lies nearest to a multiple of pi/2 of all.
  const double worst = std::ldexp(6381956970095103.0, 797);
  EXPECT_NEAR(own::cos(worst) * 0x1p60, -4.68716592425462761112e-19 * 0x1p60, 1e-15);
  // pi from below, whose sine is what it misses.
  EXPECT_EQ(own::sin(3.141592653589793), 1.2246467991473532e-16);
  EXPECT_EQ(own::sin(1e22), -0.8522008497671888);
}

std::uint64_t add(std::uint64_t hash, double x) {
  const auto bits = std::isnan(x) ? 0 : std::bit_cast<std::uint64_t>(x);
  for (int n = 0; n < 64; n += 8) hash = (hash ^ ((bits >> n) & 0xff)) * 0x100000001b3;
  return hash;
}

TEST(Elementary, GivesTheSameBitsOnEveryMachine) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (std::uint64_t n = 0; n < 100'000; ++n) {
    const double x = argument(n), y = argument(n + 500'000);
    for (const OneArgument& f : functions) hash = add(hash, f.function(x));
    hash = add(add(add(hash, own::pow(std::abs(x), y)), own::atan2(y, x)), own::hypot(x, y));
  }
  EXPECT_EQ(hash, 16527394521231952027U);
}

}  // namespace
}  // namespace dynasurf
