#pragma once
#include <Eigen/Core>

namespace dynasurf {

/// Solves a x = b for a symmetric positive definite matrix, of which the lower triangle is read: by blocks of columns,
/// from several threads, the same bytes for any number of them.
Eigen::VectorXd solve_definite(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

}  // namespace dynasurf
