#include "dynasurf/psf_fit/detail/matrix_loops.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/psf_fit/detail/cholesky.hpp"
#include "dynasurf/psf_fit/detail/lane_math.hpp"

namespace dynasurf::psf_fit::detail {
namespace {

// What the header promises.
constexpr double promised = 3e-7;

/// In [-1, 1], the same on every machine.
double drawn(std::mt19937& random) { return static_cast<double>(random()) / 2147483647.5 - 1; }

AlignedMatrix some_lines(std::size_t count, std::size_t length, unsigned seed) {
  std::mt19937 random(seed);
  AlignedMatrix lines(count, length);
  for (std::size_t n = 0; n < count; ++n)
    for (std::size_t i = 0; i < length; ++i) lines.line(n)[i] = static_cast<float>(drawn(random));
  return lines;
}

Eigen::MatrixXd dense(const AlignedMatrix& lines) {
  Eigen::MatrixXd m(static_cast<Eigen::Index>(lines.count), static_cast<Eigen::Index>(lines.length));
  for (Eigen::Index n = 0; n < m.rows(); ++n)
    for (Eigen::Index i = 0; i < m.cols(); ++i) m(n, i) = lines.line(static_cast<std::size_t>(n))[i];
  return m;
}

TEST(FitLoops, RaiseEToAnyPowerThatAFloatHolds) {
  for (double x = -87; x < 88; x += 0.0137) {
    const auto power = static_cast<float>(x);
    ASSERT_NEAR(static_cast<double>(exp_of(power)) / std::exp(static_cast<double>(power)), 1, promised) << x;
  }
  EXPECT_EQ(exp_of(0), 1);
  EXPECT_EQ(exp_of(-1000), exp_of(-87));
  EXPECT_EQ(exp_of(1000), exp_of(88));
}

TEST(FitLoops, TakeCubeRootsFromTinyToHuge) {
  for (double x = 1e-28; x < 1e28; x *= 1.0173) {
    const auto cube = static_cast<float>(x);
    ASSERT_NEAR(static_cast<double>(cube_root(cube)) / std::cbrt(static_cast<double>(cube)), 1, promised) << x;
  }
}

TEST(FitLoops, StepAsAGaussianDoesUntilItIsOver) {
  for (double s = -4.49; s < 4.49; s += 0.00173) {
    const auto at = static_cast<float>(s);
    const Step step = normal_cdf(at);
    const double t = static_cast<double>(at);
    ASSERT_NEAR(static_cast<double>(step.share), 0.5 * std::erfc(-t * std::sqrt(0.5)), promised) << s;
    ASSERT_NEAR(static_cast<double>(step.slope), std::exp(-0.5 * t * t) * 0.3989422804, promised) << s;
  }
  for (const float far : {4.5F, 1e10F}) {
    EXPECT_EQ(normal_cdf(far).share, 1);
    EXPECT_EQ(normal_cdf(-far).share, 0);
    EXPECT_EQ(normal_cdf(far).slope, 0);
  }
}

TEST(FitLoops, SumSquaresAsAMatrixProductDoes) {
  for (const std::array<std::size_t, 2> size : {std::array<std::size_t, 2>{1, 1}, {300, 37}, {129, 96}}) {
    const AlignedMatrix lines = some_lines(size[0], size[1], 1);
    const Eigen::MatrixXd expected = dense(lines).transpose() * dense(lines);
    AlignedMatrix squares = no_squares(lines.length);
    syrk(lines, lines.count, squares);
    for (Eigen::Index i = 0; i < expected.rows(); ++i)
      for (Eigen::Index j = 0; j <= i; ++j)
        // Rounding of a sum of a few hundred products below 1.
        ASSERT_NEAR(squares.line(static_cast<std::size_t>(i))[j], expected(i, j), 1e-4) << i << ' ' << j;
  }
}

TEST(FitLoops, AddLinesByTheirFactors) {
  for (const std::size_t count : {1U, 4U, 7U}) {
    const AlignedMatrix lines = some_lines(count, 45, 2);
    std::vector<const float*> from;
    std::vector<float> factor;
    Eigen::VectorXd factors(static_cast<Eigen::Index>(count));
    for (std::size_t n = 0; n < count; ++n) {
      from.push_back(lines.line(n));
      factor.push_back(0.5F * static_cast<float>(n) - 0.75F);
      factors[static_cast<Eigen::Index>(n)] = 0.5 * static_cast<double>(n) - 0.75;
    }
    std::vector<float> to(45, 3.0F);
    add_lines(to.data(), to.size(), from.data(), factor.data(), count);
    const Eigen::VectorXd expected = dense(lines).transpose() * factors;
    for (std::size_t i = 0; i < to.size(); ++i)
      EXPECT_NEAR(static_cast<double>(to[i]), 3 + expected[static_cast<Eigen::Index>(i)], 1e-5);
  }
}

TEST(FitLoops, ProjectByTheTransposeOfWhatTheyBlendBy) {
  constexpr std::size_t lines = 5, length = 70;
  const AlignedMatrix harmonics = some_lines(lines, length, 3);
  for (const std::size_t gates : {1U, 4U, 6U}) {
    std::mt19937 random(4);
    std::vector<float> factor(lines * gates), back(lines * gates);
    for (float& f : factor) f = static_cast<float>(drawn(random));
    AlignedMatrix blended(gates, length);
    gemm(harmonics, lines, factor.data(), 0, harmonics.pitch(), blended);
    gemm_t(harmonics, lines, blended, 0, harmonics.pitch(), back.data());
    Eigen::MatrixXd factors(lines, static_cast<Eigen::Index>(gates));
    for (std::size_t n = 0; n < factor.size(); ++n)
      factors(static_cast<Eigen::Index>(n / gates), static_cast<Eigen::Index>(n % gates)) = factor[n];
    const Eigen::MatrixXd fields = dense(harmonics).transpose() * factors, sums = dense(harmonics) * fields;
    for (std::size_t g = 0; g < gates; ++g) {
      const auto gate = static_cast<Eigen::Index>(g);
      for (std::size_t i = 0; i < length; ++i)
        ASSERT_NEAR(blended.line(g)[i], fields(static_cast<Eigen::Index>(i), gate), 1e-5);
      for (std::size_t n = 0; n < lines; ++n)
        ASSERT_NEAR(back[n * gates + g], sums(static_cast<Eigen::Index>(n), gate), 1e-4);
    }
  }
}

TEST(FitLoops, HaveTheSameBytesWithVectorsOfAnyWidth) {
  constexpr std::size_t count = 129, length = 96, gates = 6;
  const AlignedMatrix lines = some_lines(count, length, 5), factors = some_lines(1, count * gates, 6);
  const auto all_sums = [&](int widest) {
    field::detail::widest_vectors = widest;
    AlignedMatrix squares = no_squares(length), blended(gates, length);
    syrk(lines, count, squares);
    gemm(lines, count, factors.values.data(), 0, lines.pitch(), blended);
    std::vector<float> back(count * gates);
    gemm_t(lines, count, blended, 0, lines.pitch(), back.data());
    const std::vector<double> from(lines.values.begin(), lines.values.end());
    std::vector<double> rest(length * length);
    syrk_downdate(from.data(), count, length, 0, 0, length, rest.data());
    std::vector<double> factor = rest, solved(length * length, 1.0);
    for (std::size_t i = 0; i < length; ++i) factor[i * length + i] = 100;
    solve_lines(factor.data(), length, length, solved.data(), length, length);
    field::detail::widest_vectors = 16;
    std::vector<double> sums(back.begin(), back.end());
    sums.insert(sums.end(), solved.begin(), solved.end());
    sums.insert(sums.end(), blended.values.begin(), blended.values.end());
    for (std::size_t i = 0; i < length; ++i)
      for (std::size_t j = 0; j <= i; ++j) sums.insert(sums.end(), {squares.line(i)[j], rest[i * length + j]});
    return sums;
  };
  const std::vector<double> widest = all_sums(16);
  for (const int width : {4, 8}) EXPECT_EQ(all_sums(width), widest) << width;
}

TEST(FitLoops, SolveDefiniteMatricesOfAnySize) {
  for (const Eigen::Index count : {1, 31, 64, 65, 200, 333}) {
    std::mt19937 random(static_cast<unsigned>(count));
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(count, count, [&] { return drawn(random); });
    Eigen::MatrixXd a = root * root.transpose();
    a.diagonal().array() += 1;
    const Eigen::VectorXd expected = Eigen::VectorXd::NullaryExpr(count, [&] { return drawn(random); });
    const Eigen::VectorXd diagonal = Eigen::VectorXd::LinSpaced(count, 0.5, 2);
    const Eigen::VectorXd b = a * expected + diagonal.cwiseProduct(expected);
    RowMatrix lower = a;
    lower.triangularView<Eigen::StrictlyUpper>().setConstant(1e300);  // must not be read
    // Conditions up to a few hundred times the count.
    const Eigen::VectorXd solved = Cholesky(lower, diagonal).solve(b);
    EXPECT_LT((solved - expected).norm(), 1e-10 * expected.norm()) << count;
    const ThreadLimit one(1);
    EXPECT_EQ(Cholesky(lower, diagonal).solve(b), solved) << count;
  }
}

/// What another processor would tell Eigen, which cuts the sums of large products by it.
class OtherCaches {
 public:
  OtherCaches() : first_(Eigen::l1CacheSize()), second_(Eigen::l2CacheSize()), third_(Eigen::l3CacheSize()) {
    Eigen::setCpuCacheSizes(4096, 32768, 32768);
  }
  ~OtherCaches() { Eigen::setCpuCacheSizes(first_, second_, third_); }
  OtherCaches(const OtherCaches&) = delete;
  OtherCaches& operator=(const OtherCaches&) = delete;

 private:
  std::ptrdiff_t first_, second_, third_;
};

TEST(FitLoops, SumProductsInTheOrderOfTheColumnsWhateverTheCaches) {
  std::mt19937 random(7);
  const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(900, 37, [&] { return drawn(random); });
  const Eigen::MatrixXd b = Eigen::MatrixXd::NullaryExpr(900, 19, [&] { return drawn(random); });
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(37, 19);
  for (Eigen::Index n = 0; n < a.rows(); ++n)
    for (Eigen::Index i = 0; i < a.cols(); ++i)
      for (Eigen::Index j = 0; j < b.cols(); ++j) expected(i, j) += a(n, i) * b(n, j);
  EXPECT_EQ(product(a.transpose(), b), expected);
  const OtherCaches other;
  EXPECT_EQ(product(a.transpose(), b), expected);
  EXPECT_EQ(product(a.topRows(1), Eigen::MatrixXd::Zero(37, 0)).cols(), 0);
}

TEST(FitLoops, TellLengthsThroughAFactorWhateverTheCaches) {
  for (const Eigen::Index count : {1, 3, 64, 67, 230}) {
    std::mt19937 random(static_cast<unsigned>(count));
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(count, count, [&] { return drawn(random); });
    Eigen::MatrixXd a = root * root.transpose();
    a.diagonal().array() += 1;
    const Eigen::MatrixXd b = Eigen::MatrixXd::NullaryExpr(count, 5, [&] { return drawn(random); });
    const Cholesky factor(a);
    const Eigen::VectorXd lengths = factor.half_norms(b), solved = factor.solve(b.col(0));
    // Independent of the factor: |L^-1 b|^2 = b' a^-1 b.
    const Eigen::VectorXd expected = b.cwiseProduct(a.fullPivLu().solve(b)).colwise().sum().cwiseSqrt();
    EXPECT_LT((lengths - expected).norm(), 1e-10 * expected.norm()) << count;
    for (Eigen::Index c = 0; c < b.cols(); ++c) EXPECT_EQ(factor.half_norm(b.col(c)), lengths[c]) << count;
    const OtherCaches other;
    const Cholesky again(a);
    EXPECT_EQ(again.half_norms(b), lengths) << count;
    EXPECT_EQ(again.solve(b.col(0)), solved) << count;
  }
}

TEST(FitLoops, FactorWithFiniteNumbersWhatIsNotPositive) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(70, 70);
  a(3, 3) = -1, a(69, 69) = 0;
  const Eigen::VectorXd solved = Cholesky(a).solve(Eigen::VectorXd::Ones(70));
  EXPECT_EQ(solved, Eigen::VectorXd::Ones(70));
}

}  // namespace
}  // namespace dynasurf::psf_fit::detail
