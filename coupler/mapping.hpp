#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <limits>
#include <string>
#include <vector>

#include "proto/interface.hpp"

namespace strake {

/// What a mapping leaves to be desired.
struct MappingQuality {
  Eigen::Index n_fluid = 0, n_structure = 0;
  double largest_distance = 0;  // [m] from a fluid point to where it is mapped from
  Eigen::Index farthest = -1;   // that fluid point
  Eigen::Index outside = 0;     // fluid points beyond every face: taken from an edge or a vertex (projection)
  Eigen::Index without_load = 0;  // structure points that no fluid point uses: they feel no force
  double row_sum_error = 0;       // largest |Σ_j W_ij − 1|
};

/// One sparse matrix W between two meshes: u_f = W u_s and f_s = Wᵀ f_f, so that f_s·u_s = f_f·u_f.
/// Rows sum to 1: constants are reproduced, and Σ f_s = Σ f_f.
class Mapping {
 public:
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  explicit Mapping(Matrix weights, MappingQuality quality = {});  // n_fluid × n_structure
  Field consistent(const Field& on_structure) const;
  Field conservative(const Field& on_fluid) const;
  const Matrix& weights() const { return weights_; }
  const MappingQuality& quality() const { return quality_; }

 private:
  Matrix weights_, transpose_;
  MappingQuality quality_;
};

/// Each throws Error(case_file) when a mesh is empty, the dimensions differ, a position is not finite, or a
/// fluid point lies farther than `limit` [m] from where it would be mapped from.
Mapping nearest_neighbour(const InterfaceMesh& structure, const InterfaceMesh& fluid,
                          double limit = std::numeric_limits<double>::infinity());
/// The nearest point of the nearest face (segment in 2-D, triangle in 3-D); falls back to an edge or a
/// vertex.
Mapping nearest_projection(const InterfaceMesh& structure, const InterfaceMesh& fluid,
                           double limit = std::numeric_limits<double>::infinity());
/// W = 1, for volume coupling: both meshes are the same points.
Mapping identity(const InterfaceMesh& structure, const InterfaceMesh& fluid);
/// kind: "nearest-neighbour" | "nearest-projection" | "identity".
Mapping make_mapping(const std::string& kind, const InterfaceMesh& structure, const InterfaceMesh& fluid,
                     double limit = std::numeric_limits<double>::infinity());

}  // namespace strake
