#include "dynasurf/psf_fit/detail/cholesky.hpp"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/psf_fit/detail/matrix_loops.hpp"

namespace dynasurf::psf_fit {

Eigen::VectorXd solve_definite(const RowMatrix& a, const Eigen::VectorXd& diagonal, const Eigen::VectorXd& b) {
  constexpr Eigen::Index block = 64;
  const Eigen::Index count = a.rows();
  const auto pitch = static_cast<Eigen::Index>(detail::filled_up(static_cast<std::size_t>(count)));
  RowMatrix lower(pitch, pitch);
  parallel_for(static_cast<std::size_t>(pitch), detail::line_step, [&](std::size_t from, std::size_t to) {
    const auto at = static_cast<Eigen::Index>(from), end = static_cast<Eigen::Index>(to);
    lower.middleRows(at, end - at) = RowMatrix::Identity(pitch, pitch).middleRows(at, end - at);
    if (at >= count) return;
    const Eigen::Index rows = std::min(end, count) - at;
    lower.block(at, 0, rows, at + rows) = a.block(at, 0, rows, at + rows);
    lower.diagonal().segment(at, rows) += diagonal.segment(at, rows);
  });
  RowMatrix panel(block, pitch);  // columns of the factor, lying
  for (Eigen::Index k = 0; k < pitch; k += block) {
    const Eigen::Index columns = std::min(block, pitch - k), rest = pitch - k - columns;
    const Eigen::MatrixXd corner = lower.block(k, k, columns, columns);
    const Eigen::MatrixXd factor = corner.llt().matrixL();
    lower.block(k, k, columns, columns) = factor;
    if (rest == 0) break;
    constexpr std::size_t rows = detail::line_step;
    const auto first = static_cast<std::size_t>(k + columns), end = static_cast<std::size_t>(pitch);
    parallel_for(end - first, 2 * rows, [&](std::size_t from, std::size_t to) {
      const auto at = static_cast<Eigen::Index>(first + from), length = static_cast<Eigen::Index>(to - from);
      const Eigen::MatrixXd solved =
          factor.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd(lower.block(at, k, length, columns).transpose()));
      panel.block(0, at, columns, length) = solved;
      lower.block(at, k, length, columns) = solved.transpose();
    });
    parallel_for(end - first, rows, [&](std::size_t from, std::size_t to) {
      detail::syrk_downdate(panel.data(), static_cast<std::size_t>(columns), end, first, first + from, first + to,
                            lower.data());
    });
  }
  Eigen::VectorXd x = b;
  const auto triangle = lower.topLeftCorner(count, count).triangularView<Eigen::Lower>();
  triangle.solveInPlace(x);
  triangle.transpose().solveInPlace(x);
  return x;
}

}  // namespace dynasurf::psf_fit
