#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

#include <memory>
#include <string>
#include <vector>

namespace strake {

/// A long vector that is never changed once it is made, so that copies of a state share it.
using SharedColumn = std::shared_ptr<const Eigen::VectorXd>;
using SharedColumns = std::vector<SharedColumn>;

/// Cᵀ v, one pass over the columns.
Eigen::VectorXd transposed_times(const SharedColumns&, const Eigen::Ref<const Eigen::VectorXd>& v);
/// v + C a, one pass over the columns.
void add_times(const SharedColumns&, const Eigen::VectorXd& a, Eigen::Ref<Eigen::VectorXd> v);
/// v ← v − C a, and Cᵀ v of what is left, in one pass over the columns.
Eigen::VectorXd subtract_and_project(const SharedColumns&, const Eigen::VectorXd& a,
                                     Eigen::Ref<Eigen::VectorXd> v);
/// The columns of C M.
SharedColumns combine(const SharedColumns&, const Eigen::MatrixXd& m);

/// All columns side by side, and back: for checkpoints.
Eigen::MatrixXd to_matrix(const SharedColumns&);
SharedColumns to_columns(const Eigen::MatrixXd&);

/// Vectors V = Q T by an orthonormal basis Q. Vectors are appended at the end, where Gram–Schmidt needs no
/// more than the new one; a vector that brings no direction of its own adds none to the basis. Vectors are
/// dropped from the front, which leaves Q larger than it has to be until `compress`.
struct OrthonormalBasis {
  SharedColumns basis;          // Q
  Eigen::MatrixXd coordinates;  // T, basis × vectors

  void append(Eigen::VectorXd vector);
  void drop_oldest(Eigen::Index n);
  /// Rebuilds Q for the span of the remaining vectors, once it is half as large again as needed. Spread over
  /// the vectors that were dropped, the work is O(columns·n) for each.
  void compress();
};

/// A matrix J = L Zᵀ of few columns.
struct LowRank {
  SharedColumns left, right;

  Eigen::VectorXd times(const Eigen::VectorXd& v) const;
  void add(const SharedColumns& more_left, const SharedColumns& more_right);
  /// Replaces J by its best approximation by at most `rank` columns in the scaled space D J D⁻¹. Singular
  /// values below `smallest` of the largest are dropped. scale: the diagonal of D.
  void truncate(Eigen::Index rank, double smallest, const Eigen::VectorXd& scale);

  void save(Archive&, const std::string& name) const;
  void load(const Archive&, const std::string& name);
};

}  // namespace strake
