#pragma once

#include "proto/values.hpp"

#include <Eigen/SparseCore>

#include <memory>

namespace strake {

/// A sparse matrix between the points of two meshes, and what it makes of a field. It never changes: copies
/// share it.
class SparseOperator {
 public:
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  SparseOperator() = default;                // none
  explicit SparseOperator(Matrix&& matrix);  // swapped out of it: Eigen 3.4 moves no sparse matrix
  explicit operator bool() const { return matrix_ != nullptr; }
  const Matrix& matrix() const { return *matrix_; }
  SparseOperator transposed() const;
  Eigen::Index empty_rows() const;
  /// The block of a larger matrix: it begins at row and column `first`, and the whole has `size` of them.
  struct Place {
    Eigen::Index first = 0, size = 0;
  };
  SparseOperator embedded(const Place& rows, const Place& columns) const;

  /// mapped_i = Σ_j W_ij value_j: components×columns of the matrix → components×rows of it. Does not depend
  /// on the number of threads. The identity gives the same numbers, shared: there alone a −0 stays one, which
  /// a sum makes 0.
  Values operator*(const Values&) const;

 private:
  std::shared_ptr<const Matrix> matrix_;
  bool selects_ = false;      // each row is a single 1, as of nearest neighbours
  bool is_identity_ = false;  // row i selects column i: meshes that match, and all volume coupling
};

}  // namespace strake
