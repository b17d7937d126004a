#include "dynasurf/psf_fit/detail/cholesky.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/psf_fit/detail/matrix_loops.hpp"

namespace dynasurf::psf_fit {

Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b) {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(a.rows(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j)
    detail::add_lines(sums.col(j).data(), a.rows(), a.data(), a.outerStride(), b.col(j).data(), a.cols());
  return sums;
}

Cholesky::Cholesky(const RowMatrix& a, const Eigen::VectorXd& diagonal) : count_(a.rows()) {
  constexpr Eigen::Index block = detail::corner_size;
  const Eigen::Index pitch = detail::filled_up(count_);
  lower_.resize(pitch, pitch);
  parallel_for(pitch, detail::line_step, [&](std::size_t from, std::size_t to) {
    const Eigen::Index at = from, end = to;
    // Lines that fill up the last block are those of the identity, which factor into themselves and touch no other.
    lower_.middleRows(at, end - at) = RowMatrix::Identity(pitch, pitch).middleRows(at, end - at);
    if (at >= count_) return;
    const Eigen::Index rows = std::min(end, count_) - at;
    lower_.block(at, 0, rows, at + rows) = a.block(at, 0, rows, at + rows);
    lower_.diagonal().segment(at, rows) += diagonal.segment(at, rows);
  });
  // Right-looking, block by block: factor the corner, solve what lies under it, take its products from all that
  // follows.
  RowMatrix panel(block, pitch);  // columns of the factor, lying
  for (Eigen::Index k = 0; k < pitch; k += block) {
    const Eigen::Index columns = std::min(block, pitch - k), rest = pitch - k - columns;
    const std::size_t across = pitch, lines = columns;
    double* const corner = &lower_(k, k);
    detail::factor_corner(corner, lines, across);
    if (rest == 0) break;
    constexpr std::size_t rows = detail::line_step;
    const std::size_t first = k + columns;
    parallel_for(across - first, 2 * rows, [&](std::size_t from, std::size_t to) {
      const Eigen::Index at = first + from, length = to - from;
      panel.block(0, at, columns, length) = lower_.block(at, k, length, columns).transpose();
      detail::solve_lines(corner, lines, across, panel.data() + at, to - from, across);
      lower_.block(at, k, length, columns) = panel.block(0, at, columns, length).transpose();
    });
    parallel_for(across - first, rows, [&](std::size_t from, std::size_t to) {
      detail::syrk_downdate(panel.data(), lines, across, first, first + from, first + to, lower_.data());
    });
  }
}

Eigen::VectorXd Cholesky::solve(const Eigen::VectorXd& b) const {
  const std::size_t pitch = lower_.cols(), count = count_;
  Eigen::VectorXd x = b;
  detail::solve_numbers(lower_.data(), count, pitch, x.data());
  // L' x = y by lines of L, which lie together: each number that is found is taken from all before it.
  for (std::size_t i = count; i > 0;) {
    --i;
    const double* const line = lower_.data() + i * pitch;
    double& here = x[i];
    here /= line[i];
    const double less = -here;
    detail::add_lines(x.data(), i, line, pitch, &less, 1);
  }
  return x;
}

Eigen::VectorXd Cholesky::half_norms(const Eigen::MatrixXd& b) const {
  RowMatrix x = b;
  const std::size_t width = x.cols();
  detail::solve_lines(lower_.data(), count_, lower_.cols(), x.data(), width, width);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(x.cols());
  for (Eigen::Index i = 0; i < count_; ++i) squares += x.row(i).cwiseAbs2().transpose();
  return squares.cwiseSqrt();
}

double Cholesky::half_norm(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  detail::solve_numbers(lower_.data(), count_, lower_.cols(), x.data());
  double square = 0;
  for (const double v : x) square += v * v;
  return std::sqrt(square);
}

}  // namespace dynasurf::psf_fit
