#pragma once

#include "proto/interface.hpp"
#include "structure/fem/mesh/mesh.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

namespace strake::structure::fem {

/// Interpolates the finite-element field at chosen points, N u, and distributes forces in those points to the
/// nodes, Nᵀ f. The work is the same on both sides, and so is the total force. N is exact for linear fields,
/// so that the moment is the same too. On several ranks all call the same functions; each has the columns of
/// its own nodes.
template <int dim>
class PointInterpolation {
 public:
  PointInterpolation(const Discretisation<dim>& discretisation, const Points& at)
      : division_(discretisation.mesh().division), shape_(at.cols(), discretisation.mesh().n_nodes()) {
    std::vector<Eigen::Triplet<double>> entries;
    int i = 0;
    for (const auto& place : discretisation.locate(at)) {
      for (const auto& [node, weight] : place.weights) entries.emplace_back(i, node, weight);
      ++i;
    }
    shape_.setFromTriplets(entries.begin(), entries.end());
  }
  Points at_points(const Eigen::VectorXd& unknowns) const {  // 3×n
    Points values = Points::Zero(3, shape_.rows());
    values.template topRows<dim>() = (shape_ * unknowns.reshaped(dim, shape_.cols()).transpose()).transpose();
    return division_.sum(values);
  }
  Eigen::VectorXd to_unknowns(const Points& force) const {  // dim·nodes
    return (force.template topRows<dim>() * shape_).reshaped();
  }
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& weights() const { return shape_; }

 private:
  RankDivision division_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> shape_;  // points × nodes, rows sum to 1
};

}  // namespace strake::structure::fem
