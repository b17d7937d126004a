// The arithmetic that everything else is made of, one number for each part, as bytes_probe prints them. It needs few
// sources, so that test_compilers.py can have it from every compiler.
#include <Eigen/Core>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/fourier.hpp"
#include "dynasurf/core/detail/symmetric_axes.hpp"
#include "dynasurf/psf_fit/detail/cholesky.hpp"
#include "dynasurf/psf_fit/detail/matrix_loops.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

#include "bytes_hash.hpp"

namespace dynasurf {
namespace {

synthetic::Random drawn(1, 1);

void functions() {
  Hash hash;
  for (int n = 0; n < 20000; ++n) {
    const double x = 40 * (drawn.uniform() - 0.5), u = drawn.uniform();
    hash << own::exp(x) << own::expm1(u) << own::log(u) << own::pow(u, x) << own::sin(x) << own::cos(x) << own::tan(x)
         << own::asin(u) << own::acos(u) << own::atan2(x, u) << own::cbrt(x) << own::hypot(x, u) << own::erfc(x / 4)
         << own::log2(u) << own::log10(u);
  }
  hash.print("functions");
}

void draws() {
  Hash hash;
  for (int n = 0; n < 20000; ++n) hash << drawn.normal() << drawn.poisson(40 * drawn.uniform());
  hash.print("draws");
}

void axes() {
  Hash hash;
  for (int n = 0; n < 500; ++n) {
    const Mat3 root = Mat3::NullaryExpr([] { return drawn.normal(); });
    const SymmetricAxes found = symmetric_axes(root * root.transpose());
    hash << found.values;
    for (int k = 0; k < 3; ++k) hash << Vec3(found.directions.col(k));
  }
  hash.print("axes");
}

void transforms() {
  const FourierTable table = make_fourier_table(256);
  std::vector<Complex> line(256);
  for (Complex& c : line) c = {drawn.normal(), drawn.normal()};
  transform(table, line, -1);
  Hash hash;
  for (const Complex& c : line) hash << c.re << c.im;
  hash.print("transform");
}

void products() {
  psf_fit::detail::AlignedMatrix lines(200, 50), to(3, 50);
  std::vector<float> factor(600), back(600);
  for (std::size_t n = 0; n < lines.count; ++n)
    for (std::size_t i = 0; i < lines.length; ++i) lines.line(n)[i] = static_cast<float>(drawn.normal());
  for (float& f : factor) f = static_cast<float>(drawn.normal());
  psf_fit::detail::AlignedMatrix squares = psf_fit::detail::no_squares(50);
  psf_fit::detail::syrk(lines, lines.count, squares);
  psf_fit::detail::gemm(lines, lines.count, factor.data(), 0, lines.pitch(), to);
  psf_fit::detail::gemm_t(lines, lines.count, to, 0, lines.pitch(), back.data());
  Hash hash;
  for (std::size_t i = 0; i < squares.count; ++i)
    for (std::size_t j = 0; j <= i && j < squares.length; ++j) hash << squares.line(i)[j];
  (hash << to.values << back).print("products");
}

void matrices() {
  const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(700, 150, [] { return drawn.normal(); });
  const Eigen::MatrixXd square = psf_fit::product(a.transpose(), a);
  const psf_fit::Cholesky factor(square);
  const Eigen::VectorXd x = factor.solve(a.row(0)), lengths = factor.half_norms(a.topRows(9).transpose());
  Hash hash;
  for (const double v : square.reshaped()) hash << v;
  for (const double v : x) hash << v;
  for (const double v : lengths) hash << v;
  hash.print("matrices");
  // What Eigen adds by itself.
  const Eigen::VectorXd by_row = a * x, by_column = a.transpose() * by_row;
  Hash sums;
  sums << x.sum() << x.norm() << x.dot(by_column) << by_row.mean() << by_column.squaredNorm() << a.cast<float>().sum()
       << a.col(3).cast<float>().norm();
  sums.print("sums of Eigen");
}

}  // namespace
}  // namespace dynasurf

int main() {
  dynasurf::functions();
  dynasurf::draws();
  dynasurf::axes();
  dynasurf::transforms();
  dynasurf::products();
  dynasurf::matrices();
}
