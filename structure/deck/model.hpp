#pragma once

#include "proto/interface.hpp"
#include "structure/body/parameters.hpp"
#include "structure/body/solid.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <set>
#include <string>
#include <vector>

namespace strake::structure::deck {

/// Weights of nodes whose sum is the value in a point: points × nodes. The transpose puts forces in the
/// points on the nodes.
using Weights = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// A finite-element model as other programs take it. Its elements are straight-sided, with nodes in their
/// corners and, if quadratic, in the middles of their edges. Nodes of a cell have the order of Abaqus,
/// CalculiX and Ansys: corners of the bottom counter-clockwise, of the top, then the middles of the bottom's,
/// the top's and the upright edges. Unknown dimension·node + component. In two dimensions values are per
/// metre of depth.
struct Model {
  int dimension = 2, degree = 2;
  Points node;              // 3×n [m], reference configuration
  Eigen::MatrixXi cell;     // 4 or 8 (degree 1), 8 or 20 (degree 2) × m
  std::vector<int> part;    // m, into `parts`
  std::vector<Part> parts;  // name and material
  std::vector<int> fixed;   // unknowns that the supports constrain, ascending

  Points interface_position;  // 3×k [m] points that the fluid's forces come in
  Weights interface;          // k × n

  std::vector<std::string> probe;  // names
  Points probe_at;                 // 3×p [m]
  Weights probe_weights;           // p × n

  Analysis analysis = Analysis::dynamic;
  Eigen::Vector3d support_velocity = Eigen::Vector3d::Zero();  // [m/s] of the frame that all this is said in
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();           // [m/s²]
  double gravity_ramp = 0;                                     // [s], see structure::ramp_factor
  Eigen::VectorXd own_load;                                    // [N] of [structure.load] at full value
  Eigen::VectorXd node_mass;  // n [kg] ∫ρN, where the mesh's own program made the model
  double own_load_ramp = 0;   // [s]
  Damping damping;

  int n_nodes() const { return static_cast<int>(node.cols()); }
  int n_cells() const { return static_cast<int>(cell.cols()); }
};

/// Converts Lagrange cells to cells with nodes in corners and edges. Lagrange cells have (degree+1)^dimension
/// nodes in lexicographic order, x fastest; `cell` and all data on nodes are replaced. Nodes in the middle of
/// a cell or of a face are removed. Their share of a load or of a probe goes to the remaining nodes, weighted
/// by the shape functions of the new element at their place. This keeps work, force and moment.
Model with_edge_nodes(Model lagrange);

/// The nodes that have a weight in any point.
std::set<int> nodes_of(const Weights&);

/// Length of the shortest edge of a cell [m].
double shortest_edge(const Model&);

/// Throws Error(case_file) for what no deck can describe.
void require_plain_materials(const Model&);

}  // namespace strake::structure::deck
