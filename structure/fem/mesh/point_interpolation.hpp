#pragma once

#include "proto/interface.hpp"
#include "structure/fem/mesh/mesh.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace strake::structure::fem {

/// Interpolates the finite-element field at chosen points, N u, and distributes forces in those points to the
/// nodes, Nᵀ f. The work is the same on both sides, and so is the total force. N is exact for linear fields,
/// so that the moment is the same too. On several ranks all call the same functions; each has the columns of
/// its own nodes.
template <int dim>
class PointInterpolation {
 public:
  PointInterpolation(const Discretisation<dim>&, const Points& at);
  Points at_points(const Eigen::VectorXd& unknowns) const;  // 3×n
  Eigen::VectorXd to_unknowns(const Points& force) const;   // dim·nodes
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& weights() const { return shape_; }

 private:
  RankDivision division_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> shape_;  // points × nodes, rows sum to 1
};

}  // namespace strake::structure::fem
