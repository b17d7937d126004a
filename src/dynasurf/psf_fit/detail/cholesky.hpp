#pragma once
#include <Eigen/Core>

namespace dynasurf::psf_fit {

/// Rows that lie together.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Solves (a + diagonal) x = b for a symmetric positive definite matrix, of which the lower triangle is read: by blocks
/// of columns, from several threads, the same bytes for any number of them.
Eigen::VectorXd solve_definite(const RowMatrix& a, const Eigen::VectorXd& diagonal, const Eigen::VectorXd& b);

}  // namespace dynasurf::psf_fit
