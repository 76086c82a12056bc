#pragma once

#include <Eigen/Core>

namespace strake::structure {

/// Eigenvalues of a symmetric matrix, ascending, and its unit eigenvectors. The lower triangle counts.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen eigen_of(const Eigen::MatrixXd&);
/// The eigenvalues alone.
Eigen::VectorXd eigenvalues_of(const Eigen::MatrixXd&);

}  // namespace strake::structure
