#pragma once

#include "proto/interface.hpp"
#include "structure/fem/mesh/mesh.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace strake::structure::fem {

/// Values of the finite-element field in chosen points, N u, and forces in those points on the nodes, Nᵀ f:
/// the work is the same on both sides, and so are the total force and (N being exact for linear fields) its
/// moment.
template <int dim>
class Transfer {
 public:
  Transfer(const Discretisation<dim>&, const Points& at);
  Points at_points(const Eigen::VectorXd& unknowns) const;  // 3×n
  Eigen::VectorXd to_unknowns(const Points& force) const;   // dim·nodes

 private:
  Eigen::SparseMatrix<double, Eigen::RowMajor> shape_;  // points × nodes, rows sum to 1
};

}  // namespace strake::structure::fem
