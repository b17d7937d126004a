#pragma once
#include <Eigen/Core>

namespace dynasurf::psf_fit {

// Eigen cuts the sums of products of large matrices, and of what is made of them, by the caches of the processor. These
// add in one order everywhere.

/// Rows that lie together.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// a b, each number summed in the order of the columns of a.
Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b);

/// A symmetric positive definite matrix as L L'. It is made by blocks of columns, from several threads, the same bytes
/// for any number of them. A pivot that is not positive counts as 1.
class Cholesky {
 public:
  /// Of a + diagonal; of `a` the lower triangle is read.
  Cholesky(const RowMatrix& a, const Eigen::VectorXd& diagonal);
  explicit Cholesky(const RowMatrix& a) : Cholesky(a, Eigen::VectorXd::Zero(a.rows())) {}

  /// x of L L' x = b.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// Lengths of x of L x = b, for each column of `b`.
  Eigen::VectorXd half_norms(const Eigen::MatrixXd& b) const;
  double half_norm(const Eigen::VectorXd& b) const;

 private:
  Eigen::Index count_;
  RowMatrix lower_;  // filled up to blocks
};

}  // namespace dynasurf::psf_fit
