#include "dynasurf/image/edges/detail/compass.hpp"

#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"

#include "support/blurred_heart.hpp"
#include "support/edge_images.hpp"

namespace dynasurf::image {
namespace {

using test::image_of;

double saturating(double difference) { return 1 - std::exp(-difference / 0.14); }

/// The judge: cheapest transport by successive shortest paths. Slow, and exact for any distance.
double exact_distance(std::vector<double> a, std::vector<double> b, const std::vector<double>& distance) {
  const std::size_t n = a.size();
  std::vector<double> flow(n * n, 0);
  double total = 0, work = 0;
  for (const double m : a) total += m;
  for (double left = total; left > 1e-12;) {
    // Bellman-Ford over 2n nodes: 0..n-1 have mass to give, n..2n-1 want it.
    std::vector<double> cost(2 * n, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> from(2 * n, 2 * n);
    for (std::size_t i = 0; i < n; ++i)
      if (a[i] > 1e-15) cost[i] = 0;
    for (std::size_t round = 0; round < 2 * n; ++round)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
          const double d = distance[i * n + j];
          if (cost[i] + d < cost[n + j] - 1e-13) cost[n + j] = cost[i] + d, from[n + j] = i;
          if (flow[i * n + j] > 1e-15 && cost[n + j] - d < cost[i] - 1e-13) cost[i] = cost[n + j] - d, from[i] = n + j;
        }
    std::size_t end = 2 * n;
    for (std::size_t j = n; j < 2 * n; ++j)
      if (b[j - n] > 1e-15 && (end == 2 * n || cost[j] < cost[end])) end = j;
    double amount = b[end - n];
    std::size_t at = end;
    for (; from[at] < 2 * n; at = from[at])
      if (at < n) amount = std::min(amount, flow[at * n + from[at] - n]);
    amount = std::min(amount, a[at]);
    a[at] -= amount, b[end - n] -= amount, left -= amount, work += amount * cost[end];
    for (at = end; from[at] < 2 * n; at = from[at]) {
      if (at >= n)
        flow[from[at] * n + at - n] += amount;
      else
        flow[at * n + from[at] - n] -= amount;
    }
  }
  return work / total;
}

struct Pair {
  std::vector<double> values, a, b;
  std::vector<double> distance(double (*of)(double)) const {
    std::vector<double> d;
    for (const double p : values)
      for (const double q : values) d.push_back(of(std::abs(p - q)));
    return d;
  }
};

std::vector<Pair> random_pairs(int count) {
  std::mt19937_64 random(3);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) / 9007199254740992.0; };
  std::vector<Pair> pairs;
  for (int n = 0; n < count; ++n) {
    Pair p;
    const std::size_t clusters = 2 + random() % 9;
    double sum_a = 0, sum_b = 0;
    for (std::size_t c = 0; c < clusters; ++c) {
      p.values.push_back(uniform());
      p.a.push_back(random() % 3 ? uniform() : 0), p.b.push_back(random() % 3 ? uniform() : 0);
      sum_a += p.a.back(), sum_b += p.b.back();
    }
    if (sum_a == 0 || sum_b == 0) continue;
    for (double& m : p.a) m /= sum_a;
    for (double& m : p.b) m /= sum_b;
    std::sort(p.values.begin(), p.values.end());
    pairs.push_back(p);
  }
  return pairs;
}

TEST(SweepDistance, IsExactForALinearDistance) {
  for (const Pair& p : random_pairs(100)) {
    const auto d = p.distance([](double x) { return x; });
    const double sweep = sweep_distance(p.a, p.b, d);
    EXPECT_NEAR(sweep, exact_distance(p.a, p.b, d), 1e-9);
    double cumulated = 0, l1 = 0;  // and equal to the area between the cumulated masses
    for (std::size_t c = 0; c + 1 < p.values.size(); ++c) {
      cumulated += p.a[c] - p.b[c];
      l1 += std::abs(cumulated) * (p.values[c + 1] - p.values[c]);
    }
    EXPECT_NEAR(sweep, l1, 1e-9);
  }
}

TEST(SweepDistance, IsNeverCheaperThanTheCheapestTransport) {
  double greedy = 0, exact = 0;
  for (const Pair& p : random_pairs(100)) {
    const auto d = p.distance(saturating);
    const double sweep = sweep_distance(p.a, p.b, d), assess = exact_distance(p.a, p.b, d);
    EXPECT_GE(sweep, assess - 1e-9);
    greedy += sweep, exact += assess;
  }
  // On unrelated random distributions, which are the worst case, the shortcut was 14 % dearer.
  EXPECT_GT(greedy, 1.05 * exact);
  EXPECT_LT(greedy, 1.3 * exact);
}

TEST(SweepDistance, IsSymmetricAndZeroOnlyForEqualDistributions) {
  for (const Pair& p : random_pairs(100)) {
    const auto d = p.distance(saturating);
    EXPECT_NEAR(sweep_distance(p.a, p.b, d), sweep_distance(p.b, p.a, d), 1e-12);
    EXPECT_NEAR(sweep_distance(p.a, p.a, d), 0, 1e-12);
    EXPECT_EQ(sweep_distance(p.a, p.b, d) > 1e-6, p.a != p.b);
  }
}

TEST(Compass, TellsContrastAndAngleOfAStep) {
  for (const double contrast : {0.1, 0.25, 0.6, 1.0})
    for (double angle = 0; angle < 360; angle += 17) {
      // One pixel in the corner spans the volume's range, so that `contrast` is a share of it.
      Image step = test::step_image(33, 16, 16, angle, 0, contrast);
      step(0, 0, 0) = 1, step(32, 32, 0) = 0;
      const CompassMaps maps = compass_maps(step, {.sigma_px = 2});
      // The step cuts the pixels of the middle line in two; they lower the distance a little.
      EXPECT_NEAR(maps.strength(16, 16, 0), saturating(contrast), 0.07) << contrast << " " << angle;
      const double found = std::atan2(maps.across_y(16, 16, 0), maps.across_x(16, 16, 0)) * 180 / std::numbers::pi;
      EXPECT_LT(std::abs(std::remainder(found - angle, 360)), 7.5) << contrast << " " << angle;
      EXPECT_LT(maps.abnormality(16, 16, 0), 0.3 * maps.strength(16, 16, 0));
    }
}

TEST(Compass, SeesATextureThatTheGradientDoesNot) {
  // Left grey, right a checkerboard of black and white: the same mean.
  const Image texture = image_of(40, 40, 1, [](int i, int j, int) { return i < 20 ? 0.5 : (i + j) % 2 ? 1.0 : 0.0; });
  const CompassMaps maps = compass_maps(texture, {.sigma_px = 2});
  EXPECT_GT(maps.strength(20, 20, 0), 0.8);
  EXPECT_LT(maps.strength(8, 20, 0), 0.05);
  EXPECT_LT(maps.strength(32, 20, 0), 0.1);
  const EdgeMap canny = detect_edges(texture, Canny{.sigma_px = 2});
  EXPECT_LT(canny.gradient(20, 20, 0), 0.02);
}

// Samples on the border of two wedges count for both sides, so neither side of the diagonal is preferred.
TEST(Compass, SeesATransposedImageAlike) {
  const auto grey = [](int i, int j) { return ((7 * i * i + 13 * j + 5 * i * j) % 17) / 16.0; };
  const Image image = image_of(15, 15, 1, [&](int i, int j, int) { return grey(i, j); });
  const Image transposed = image_of(15, 15, 1, [&](int i, int j, int) { return grey(j, i); });
  const CompassMaps maps = compass_maps(image, {.sigma_px = 1}), other = compass_maps(transposed, {.sigma_px = 1});
  for (int j = 0; j < 15; ++j)
    for (int i = 0; i < 15; ++i) EXPECT_NEAR(maps.strength(i, j, 0), other.strength(j, i, 0), 1e-5) << i << " " << j;
}

TEST(Compass, CallsAJunctionAbnormal) {
  // Three regions: however the diameter lies, the halves differ.
  const Image junction = image_of(40, 40, 1, [](int i, int j, int) { return i >= 20 ? 1.0 : j >= 20 ? 0.4 : 0.0; });
  const CompassMaps maps = compass_maps(junction, {.sigma_px = 2});
  EXPECT_GT(maps.abnormality(20, 20, 0), 0.2);
  EXPECT_LT(maps.abnormality(20, 6, 0), 0.1) << "a straight step";
}

TEST(Compass, IsSureOfAStepAndNotOfADot) {
  const Image dot = image_of(21, 21, 1, [](int i, int j, int) { return i == 10 && j == 10; });
  // The dot's own pixel has no weight: seen from there everything is alike.
  EXPECT_EQ(compass_maps(dot, {}).strength(10, 10, 0), 0);
  const CompassMaps step = compass_maps(test::step_image(33, 16, 16, 20), {.sigma_px = 2});
  EXPECT_LE(step.uncertainty_deg(16, 16, 0), 30);
}

TEST(Compass, CostsNoMoreThanAHundredTimesCanny) {
  test::HeartShape h;
  h.noise = 0.06;
  const Image m = test::blurred_heart(h);
  const ThreadLimit one(1);
  const auto cpu_seconds = [&](const auto& options) {
    const std::clock_t start = std::clock();
    detect_edges(m, options);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  for (const double sigma : {1.0, 1.8}) {
    double canny = 1e9, compass = 1e9;
    for (int n = 0; n < 5; ++n) {  // the best of five, by turns
      canny = std::min(canny, cpu_seconds(Canny{.sigma_px = sigma}));
      compass = std::min(compass, cpu_seconds(Compass{.sigma_px = sigma}));
    }
    RecordProperty("ratio_" + std::to_string(sigma), std::to_string(compass / canny));
    // 38 on an idle machine, up to 61 where both cores are busy.
    EXPECT_LT(compass, 100 * canny) << compass << " s against " << canny << " s at sigma " << sigma;
  }
}

TEST(Compass, RefusesWhatMakesNoSense) {
  const Image m = test::noise_image(8, 8, 1);
  EXPECT_THROW(detect_edges(m, Compass{.low = 0.8, .high = 0.3}), OptionError);
  EXPECT_THROW(detect_edges(m, Compass{.clusters = 11}), OptionError);
}

}  // namespace
}  // namespace dynasurf::image
