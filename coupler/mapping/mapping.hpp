#pragma once

#include "coupler/mapping/sparse_operator.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <limits>
#include <string>
#include <vector>

namespace strake {

/// What a mapping leaves to be desired.
struct MappingQuality {
  Eigen::Index n_fluid = 0, n_structure = 0;
  double largest_distance = 0;  // [m] from a fluid point to where it is mapped from
  Eigen::Index farthest = -1;   // that fluid point
  Eigen::Index outside =
      0;  // fluid points beyond every face (projection, linear cell) or patch (radial basis)
  Eigen::Index without_load = 0;  // structure points that no fluid point uses: they get no force
  double row_sum_error = 0;       // largest |Σ_j W_ij − 1|
  double row_size = 0;            // mean number of structure points behind a fluid point
  double condition = 0;           // of the worst system that was solved; 0: none was (radial basis alone)
  Eigen::Index patches = 0;       // systems that were solved
  double patch_points = 0;        // mean size of one
};

/// Where the weights of radial basis functions come from.
struct RadialBasis {
  std::string function = "wendland-c4";  // wendland-c2 | wendland-c4 | wendland-c6 | thin-plate
  double support = 0;                    // [m] where a Wendland function ends; 0: 40 spacings of the points
  std::string polynomial = "linear";     // linear | constant: reproduced exactly
  std::string solve = "partition";       // partition | global
  int patch_points = 30;                 // structure points of one patch of the partition, about
  double overlap = 0.15;                 // radius of a patch beyond the cell that it serves, relative
};

/// How displacement and force cross the interface.
struct MappingParameters {
  std::string kind = "nearest-projection";  // nearest-neighbour | nearest-projection | linear-cell |
                                            // radial-basis | identity
  std::string constraint = "conservative";  // of the force: conservative | consistent | scaled-consistent
  RadialBasis radial_basis = {};
  double limit = std::numeric_limits<double>::infinity();  // [m] farthest fluid point that is accepted
};

/// What the quality says to a reader, a line each. back: the meshes are exchanged, as for a pressure.
std::vector<std::string> quality_lines(const MappingQuality&, const Points& mapped_to, bool back = false);

/// One sparse matrix W between two meshes: u_f = W u_s and f_s = Wᵀ f_f, so that f_s·u_s = f_f·u_f.
/// Rows sum to 1: constants are reproduced, and Σ f_s = Σ f_f. The matrices never change: copies share them.
class Mapping {
 public:
  using Matrix = SparseOperator::Matrix;

  /// n_fluid × n_structure; swapped out of `weights`: Eigen 3.4 moves no sparse matrix.
  explicit Mapping(Matrix&& weights, MappingQuality quality = {});
  Field consistent(const Field& on_structure) const;
  Field conservative(const Field& on_fluid) const;
  /// The force as the case's constraint wants it: Wᵀ f_f, or by the matrix of `set_force`.
  Field force(const Field& on_fluid) const;
  /// As `consistent`, for what is per area (pressure): the integral is kept where `set_areas` was called.
  Field per_area(const Field& on_structure) const;
  const Matrix& weights() const { return weights_.matrix(); }
  const MappingQuality& quality() const { return quality_; }

  /// The force goes with a matrix of its own from now on (n_structure × n_fluid). `scaled`: each component is
  /// then scaled until Σ f_s = Σ f_f.
  void set_force(Matrix&& weights, bool scaled);
  /// Area that belongs to each point [m², m in 2-D].
  void set_areas(Eigen::VectorXd of_structure, Eigen::VectorXd of_fluid);
  /// The same between parts of larger meshes: W is a block, all else is empty. The quality stays the block's,
  /// but for the number of the farthest point.
  Mapping embedded(const SparseOperator::Place& of_fluid, const SparseOperator::Place& of_structure) const;

 private:
  SparseOperator weights_, transpose_, force_weights_;  // the last one may be none
  Eigen::VectorXd area_of_structure_, area_of_fluid_;
  MappingQuality quality_;
  bool scaled_ = false;
};

/// Each mapping throws Error(case_file) when a mesh is empty, the dimensions differ, or a position is not
/// finite. It also throws when a fluid point lies farther than `limit` [m] from its source on the structure.
Mapping nearest_neighbour(const InterfaceMesh& structure, const InterfaceMesh& fluid,
                          double limit = std::numeric_limits<double>::infinity());
/// Projects to the nearest point of the nearest face: a segment in 2-D, a triangle in 3-D. Falls back to an
/// edge or a vertex.
Mapping nearest_projection(const InterfaceMesh& structure, const InterfaceMesh& fluid,
                           double limit = std::numeric_limits<double>::infinity());
/// Evaluates the linear function of the nearest face, also beyond the surface's border for one face's length.
/// So fields linear on a plane are exact on a fluid that overhangs, too. Farther out it is the projection.
/// Needs faces: a volume of points has none and only takes radial_basis and nearest_neighbour.
Mapping linear_cell(const InterfaceMesh& structure, const InterfaceMesh& fluid,
                    double limit = std::numeric_limits<double>::infinity());
/// Interpolation by radial basis functions with a polynomial, through all points at once or patch by patch.
/// Needs no faces. Throws also when a system is singular or the global one too large.
Mapping radial_basis(const InterfaceMesh& structure, const InterfaceMesh& fluid, const RadialBasis& = {},
                     double limit = std::numeric_limits<double>::infinity());
/// W = 1, for volume coupling: both meshes are the same points.
Mapping identity(const InterfaceMesh& structure, const InterfaceMesh& fluid);
/// By name, with the constraint of the force. For a field per area (pressure) from fluid to structure make a
/// mapping with the meshes exchanged and use its `per_area`.
Mapping make_mapping(const MappingParameters&, const InterfaceMesh& structure, const InterfaceMesh& fluid);

}  // namespace strake
