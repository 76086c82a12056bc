#pragma once

#include "structure/fem/mesh/mesh.hpp"

#include <Eigen/Core>

#include <vector>

namespace strake::structure::fem {

/// Extrapolates values from the quadrature points to the nodes. In each cell it fits, in the L2 norm, the
/// polynomial of degree one in each direction. For Q2 that is the one through the 2×2(×2) points where
/// stresses are most exact (Barlow 1976). A node gets the mean over the cells of one part that meet there. A
/// node between parts has a value for each part, so that a jump of the material stays a jump.
template <int dim>
class Recovery {
 public:
  explicit Recovery(const Mesh<dim>&);
  int size() const { return static_cast<int>(node_.size()); }  // pairs of a node and a part
  const std::vector<int>& node() const { return node_; }       // of each, ascending
  const std::vector<int>& part() const { return part_; }       // of each
  const Eigen::MatrixXi& cell() const { return cell_; }        // like Mesh::cell, into the pairs
  /// components × (m · n_quadrature) → components × size().
  Eigen::MatrixXd on_nodes(const Eigen::MatrixXd& at_quadrature) const;

  /// Averages a density over the volume nearest to each node; same shapes. If no quadrature point is
  /// negative, no node is. A frame shows the pieces of cells between nodes, linear in each direction. The
  /// integral over these pieces equals the sum over the quadrature points, exactly for bodies whose cells are
  /// boxes, else nearly.
  Eigen::MatrixXd means_on_nodes(const Eigen::MatrixXd& at_quadrature) const;
  /// Volume of each pair's share [m^dim].
  Eigen::VectorXd shares_of_volume() const;

  /// What the points of quadrature of one cell have in a value.
  struct Share {
    int cell = 0;
    Eigen::VectorXd weight;  // n_quadrature
  };
  /// Of the recovered field in a place of a cell: it needs the cells around it and no others. On several
  /// ranks the sum over them.
  std::vector<Share> shares(int cell, const NodeWeights&) const;

 private:
  Eigen::MatrixXd sum_on_nodes(const Eigen::MatrixXd& at_quadrature, const Eigen::MatrixXd& to_nodes) const;
  const Mesh<dim>& mesh_;
  Eigen::MatrixXd
      nearest_;  // like Mesh::fit: part of a point's volume that is nearest to a node; columns sum to 1
  std::vector<int> node_, part_;
  Eigen::MatrixXi cell_;
  std::vector<std::vector<int>> around_;  // of each pair, the cells
};

}  // namespace strake::structure::fem
