#pragma once

#include "structure/body/parameters.hpp"
#include "structure/fem/mesh/rank_division.hpp"

#include <Eigen/Core>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace strake::structure::fem {

/// A finite-element mesh as plain arrays: all that the kernels need of it. Unknown dim·node + component. Of a
/// body on several ranks it holds the rank's own cells and those beside them (rank_division.hpp).
template <int dim>
struct Mesh {
  int degree = 2;                                   // of the Lagrange element
  int n_quadrature = 0;                             // points per cell
  Eigen::Matrix<double, dim, Eigen::Dynamic> node;  // dim×n [m], reference configuration
  Eigen::MatrixXi cell;                             // nodes per cell × m, lexicographic: x fastest
  Eigen::MatrixXd
      gradient;  // (nodes per cell · dim) × (m · n_quadrature) [1/m]: ∂N_a/∂X_k in row k·nodes + a
  Eigen::VectorXd weight;  // m · n_quadrature [m^dim]: quadrature weight × Jacobian
  Eigen::MatrixXd shape;   // nodes per cell × n_quadrature, N_a
  Eigen::MatrixXd
      fit;  // the same: values in the points → the fit of degree one along each axis, in the nodes
  Eigen::Matrix<double, dim, Eigen::Dynamic> point;  // dim × n_quadrature in the reference cell, −1 to 1
  Eigen::VectorXd reference_weight;                  // n_quadrature, sum 1
  Eigen::MatrixXd centre_inverse;  // (dim·dim) × m [1/m]: inverse of ∂X/∂ξ at the centre of the corners
  Eigen::MatrixXi outside;  // 2·dim × m: 1 where a cell ends the body at its face −ξ, +ξ, −η, …
  std::vector<int> part;    // m, of the solid
  std::vector<int> fixed;   // unknowns that the supports constrain, ascending
  RankDivision division;    // among ranks
  std::vector<int> number;  // m, of a cell in the whole body; ascending
  std::vector<char> own;    // m, whether a cell counts for this rank
  int cells_of_body = 0;    // of all ranks

  int n_nodes() const { return static_cast<int>(node.cols()); }
  int n_cells() const { return static_cast<int>(cell.cols()); }
  int n_unknowns() const { return dim * n_nodes(); }
  bool owns(int c) const { return own[static_cast<std::size_t>(c)] != 0; }
  /// A value of each cell of the whole body as its owner has it, on all ranks; and the rank's part of them.
  Eigen::VectorXd whole(const Eigen::VectorXd& of_cells) const {
    Eigen::VectorXd all = Eigen::VectorXd::Constant(cells_of_body, RankDivision::nothing);
    for (int c = 0; c < n_cells(); ++c)
      if (owns(c)) all(number[static_cast<std::size_t>(c)]) = of_cells(c);
    return division.sum(all);
  }
  Eigen::VectorXd part_of_whole(const Eigen::VectorXd& of_cells) const { return of_cells(number); }
  /// Node in a corner of a cell, corners in lexicographic order.
  int corner(int c, int k) const {
    int at = 0;
    for (int axis = dim - 1; axis >= 0; --axis) at = at * (degree + 1) + degree * ((k >> axis) & 1);
    return cell(at, c);
  }
  Eigen::Vector3d place(int i) const {  // of a node in space [m]
    Eigen::Vector3d X = Eigen::Vector3d::Zero();
    X.head<dim>() = node.col(i);
    return X;
  }
};

/// The body's rigid motions, one per column, zero in fixed unknowns. In space these are three translations
/// and three rotations about its middle, in units of its size; in the plane two and one.
template <int dim>
Eigen::MatrixXd rigid_motions(const Mesh<dim>&);

/// How many of the body's rigid motions (three in the plane, six in space) no fixed unknown stops.
template <int dim>
int rigid_motions_left(const Mesh<dim>&);
/// Statics need all rigid motions stopped: throws Error(case_file) otherwise.
template <int dim>
void require_constrained(const Mesh<dim>&);
/// A body that deforms needs unknowns that no support holds: throws Error(case_file) otherwise.
template <int dim>
void require_free(const Mesh<dim>&);

/// Weights of nodes whose sum is the value in a point.
using NodeWeights = std::vector<std::pair<int, double>>;

/// "deal.II 9.4.1".
std::string library();
/// How many threads sums over cells use; the results do not depend on it.
void use_threads(int);

/// A body divided into cells, and its Lagrange element. The only place where deal.II's mesh, element,
/// mapping and quadrature are used; everything else works on the plain `Mesh`.
template <int dim>
class Discretisation {
 public:
  /// `refinement`, `along`: see refinement.hpp. Throws Error(case_file) where a support finds no node. With
  /// several ranks, which are the processes of MPI_COMM_WORLD, each gets a part.
  Discretisation(const Solid&, int degree, int refinement, double along = 0, Communicator* ranks = nullptr);
  ~Discretisation();
  const Mesh<dim>& mesh() const { return mesh_; }
  /// A material point: its cell, −1 where the rank does not have it, and the shape values of the rank's own
  /// nodes.
  struct Place {
    int cell = -1;
    NodeWeights weights;
  };
  /// Finds points X [m]. A point outside is moved to the nearest place of the nearest cell.
  std::vector<Place> locate(const Points& X) const;
  /// n [m^(dim-1)]: ∫ N_a dS over facets of the solid.
  Eigen::VectorXd face_sizes(const std::vector<int>& facets) const;
  /// [structure.load] at full value on the unknowns [N].
  Eigen::VectorXd case_force(const CaseLoad&) const;

 private:
  struct Parts;
  void divide(const Solid& cells, Communicator& ranks);
  void take_cells();
  void copy_element(int degree);
  void copy_cells();
  void constrain_all(int refinement);
  void constrain(const SupportedFace&, double near);

  Solid solid_;
  std::unique_ptr<Parts> parts_;
  Mesh<dim> mesh_;
};

}  // namespace strake::structure::fem
